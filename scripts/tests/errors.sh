#!/bin/bash
# Input that cannot be used gives one clear sentence and a non-zero exit, and spoils no earlier result: scripts/tests/errors.sh RAYPOOL
# Needs the Verilated unit of 4w4c beside RAYPOOL.
set -u -o pipefail
raypool=$(realpath "$1")
cd "$(dirname "$0")/../.." || exit 1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
failures=0

# refuses WHAT PATTERN COMMAND...: exit code 1, nothing but one line on standard error, which matches PATTERN.
refuses() {
  local what=$1 pattern=$2 code=0; shift 2
  timeout 120 "$@" > "$folder/stdout" 2> "$folder/stderr" || code=$?
  if [ "$code" = 1 ] && [ "$(wc -l < "$folder/stderr")" = 1 ] && grep -qE -e "$pattern" "$folder/stderr"; then
    echo "ok: $what: $(cat "$folder/stderr")"
  else
    failures=$((failures + 1))
    echo "FAILED: $what: exit $code, wanted 1 and one line that matches '$pattern', got:"
    cat "$folder/stdout" "$folder/stderr"
    printf 'again:'; printf ' %q' "$@"; echo
  fi
}

triangle='v 0 0 0
v 1 0 0
v 0 1 0'
printf '%s\nf 1 2 9\n' "$triangle" > "$folder/index.obj"
printf '%s\nf 1 2 -9\n' "$triangle" > "$folder/negative.obj"
printf 'v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n' > "$folder/nan.obj"
printf '%s\nf 1 2 3\n' "$triangle" > "$folder/good.obj"
echo '{"warps": 3}' > "$folder/warps.json"
echo '{"warps": ' > "$folder/broken.json"
echo '{"wraps": 8}' > "$folder/unknown.json"
printf 'iadd r1, r1, 1\njany 5000\nexit\n' > "$folder/far.asm"
printf 'iadd r1, r1, 1\n' > "$folder/end.asm"
printf 'mov r1, 0x7ffffff0\nld r2, [r1+0]\nexit\n' > "$folder/load.asm"
printf 'mov r1, 0\nnonsense r1\nexit\n' > "$folder/word.asm"
printf 'again:\njany again\nexit\n' > "$folder/forever.asm"

sim=("$raypool" sim --engine functional --size 8x8 --out "$folder/out" --quiet)
refuses "missing OBJ" "$folder/none.obj" "${sim[@]}" --scene "$folder/none.obj"
refuses "OBJ index out of range" "index.obj" "${sim[@]}" --scene "$folder/index.obj"
refuses "OBJ negative index out of range" "negative.obj" "${sim[@]}" --scene "$folder/negative.obj"
refuses "OBJ with a NaN" "nan.obj" "${sim[@]}" --scene "$folder/nan.obj"
refuses "no such scene" "nosuchscene" "${sim[@]}" --scene nosuchscene
refuses "missing view" "none.json" "${sim[@]}" --view "$folder/none.json"
refuses "3 warps in a file" "warps.* 3.*power of two from 1 to 32" "${sim[@]}" --config "$folder/warps.json"
refuses "3 warps by name" "3.*power of two from 1 to 32" "${sim[@]}" --config 3w8c
refuses "configuration that is not JSON" "broken.json" "${sim[@]}" --config "$folder/broken.json"
refuses "configuration with an unknown key" "wraps" "${sim[@]}" --config "$folder/unknown.json"
refuses "size 0x0" "0x0.*1 to 16384" "${sim[@]}" --size 0x0
refuses "size without x" "1 to 16384" "${sim[@]}" --size 64
refuses "depth 0" "depth.*1" "${sim[@]}" --depth 0
refuses "3 compute units" "3" "${sim[@]}" --units 3
refuses "unknown engine" "native, functional, model, rtl or lockstep" "${sim[@]}" --engine spice
refuses "unknown traverser" "static" "${sim[@]}" --traverser quick
refuses "engine without a built unit" "make unit" "${sim[@]}" --engine rtl --unit-library "$folder/none.so"
refuses "results folder that is a file" "good.obj" "${sim[@]}" --out "$folder/good.obj"
cosim=("$raypool" cosim --programs 2 --save "$folder/saved" --quiet)
refuses "random programs without a built unit" "none.so.*make" "${cosim[@]}" --config 4w4c --unit-library "$folder/none.so"
refuses "random programs, a unit that is no library" "good.obj.*cannot be loaded" "${cosim[@]}" --config 4w4c --unit-library "$folder/good.obj"
refuses "random programs on another configuration's unit" "build it for this configuration" \
  "${cosim[@]}" --config 2w2c --unit-library "$(echo "$(dirname "$raypool")"/units/4w4c-????????/libraypool_unit.so)"
refuses "random programs, 3 warps" "3.*power of two from 1 to 32" "${cosim[@]}" --config "$folder/warps.json"
refuses "program that was not saved" "none.json" "${cosim[@]}" --replay "$folder/none.json"
if [ -e "$folder/saved" ]; then
  failures=$((failures + 1))
  echo "FAILED: what is wrong around the programs was saved as a program that fails: $(ls "$folder/saved")"
fi
refuses "waveform of an engine without one" "waveform" "${sim[@]}" --waves
refuses "unknown option" "--help" "${sim[@]}" --colour
refuses "unknown kernel" "saxpy" "$raypool" run sexpy
refuses "assembly error names line and column" "word.asm:2:" "$raypool" run "$folder/word.asm"

for engine in functional rtl lockstep; do
  # A clock of the functional engine is thousands of instructions.
  limit=100000
  [ "$engine" != functional ] || limit=100
  run=("$raypool" run --config 4w4c --engine "$engine" --cycles "$limit")
  refuses "$engine: jump out of the program" "outside the program" "${run[@]}" "$folder/far.asm"
  refuses "$engine: program without an end" "outside the program" "${run[@]}" "$folder/end.asm"
  refuses "$engine: load out of memory" "outside the memory" "${run[@]}" "$folder/load.asm"
  refuses "$engine: endless program" "limit of $limit cycles" "${run[@]}" "$folder/forever.asm"
done

# What an earlier run has left survives a failed one, and nothing else is left.
"${sim[@]}" --scene "$folder/good.obj" > "$folder/stdout" 2>&1 || { failures=$((failures + 1)); echo "FAILED: a good OBJ:"; cat "$folder/stdout"; }
before=$(cd "$folder/out" && ls -A && cksum ./*)
refuses "failed run over an earlier one" "nan.obj" "${sim[@]}" --scene "$folder/nan.obj"
if [ "$before" != "$(cd "$folder/out" && ls -A && cksum ./*)" ]; then
  failures=$((failures + 1))
  echo "FAILED: a failed run changed the results of the earlier one: $(ls -lA "$folder/out")"
fi

[ "$failures" = 0 ] || { echo "$failures cases failed"; exit 1; }
