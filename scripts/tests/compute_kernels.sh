#!/bin/bash
# saxpy, matmul and an assembly program give the results that C++ gives, on every engine:
# scripts/tests/compute_kernels.sh RAYPOOL CONFIG
# Needs the Verilated unit of CONFIG beside RAYPOOL.
set -eu -o pipefail
raypool=$(realpath "$1") config=$2
cd "$(dirname "$0")/../.."
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

# out[tid] = tid * argument 0, for each thread of two blocks; block b writes at 256 + 64 b.
cat > "$folder/scale.asm" <<'END'
tid r1
arg r2, 0
imul r3, r1, r2
block r4
shl r4, r4, 6
shl r5, r1, 2
iadd r4, r4, r5
st [r4+256], r3
exit
END
for engine in functional rtl lockstep; do
  for kernel in saxpy matmul; do
    "$raypool" run "$kernel" --config "$config" --engine "$engine" | tee "$folder/text"
    grep -qE '[1-9][0-9]* results, 0 wrong' "$folder/text"
  done
  "$raypool" run "$folder/scale.asm" --config "$config" --engine "$engine" --blocks 2 --threads 8 --arg 3 \
    --print 256:8 --print 320:8 > "$folder/text"
  wanted='00000000 00000003 00000006 00000009 0000000c 0000000f 00000012 00000015'
  if [ "$(grep -cF "$wanted" "$folder/text")" != 2 ]; then
    echo "FAILED: wrong words from $engine:"
    cat "$folder/text"
    exit 1
  fi
done
