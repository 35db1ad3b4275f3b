#!/bin/bash
# A difference is run again with a look inside the RTL, and the report names the file:
# scripts/tests/inspect.sh RAYPOOL FOLDER
# FOLDER has the machine 2w2c with the seeded faults, as python3 -m faults builds it.
set -u -o pipefail
raypool=$(realpath "$1") machine=$(realpath "$2")/catalogue/2w2c/libraypool_unit.so
cd "$(dirname "$0")/../.." || exit 1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
failures=0
on=(--config tb/mutants/2w2c.json --unit-library "$machine" --quiet)
twice='raypool: lockstep difference in unit: .*, in cycle [0-9]+: running again'

# differs WHAT FAULT PATTERN COMMAND...: with the fault the command ends with 2, prints nothing but one report, and that
# matches.
differs() {
  local what=$1 fault=$2 pattern=$3 code=0; shift 3
  RAYPOOL_FAULT=$fault timeout 120 "$raypool" "$@" > "$folder/stdout" 2> "$folder/stderr" || code=$?
  if [ "$code" = 2 ] && [ ! -s "$folder/stdout" ] && [ "$(grep -c 'look at: ' "$folder/stderr")" = 1 ] &&
    grep -qzE -e "$pattern" "$folder/stderr"; then
    echo "ok: $what"
  else
    failures=$((failures + 1))
    echo "FAILED: $what: exit $code, wanted 2 and one report that matches '$pattern', got:"
    cat "$folder/stdout" "$folder/stderr"
  fi
}

# Without a look inside, a warp that retires early leads to instruction buffer and cache.
arbiter='inside, [0-9]+ cycles before: fetch arbiter, grant.*'
arbiter+='look at: rtl/compute/rp_fetch_arbiter.v, rtl/common/rp_round_robin.v'
differs "a compute kernel" 45 "$twice.*$arbiter" run matmul --n 6 --engine lockstep "${on[@]}"
sim=(sim --scene cornell --size 16x16 --out "$folder/frame" "${on[@]}")
"$raypool" "${sim[@]}" --engine functional || { failures=$((failures + 1)); echo "FAILED: no frame to spoil"; }
before=$(cd "$folder/frame" && ls -A && cksum ./*)
differs "a frame" 52 \
  "$twice.*inside, [0-9]+ cycles before: instruction cache.*look at: rtl/compute/rp_instruction_cache.v" \
  "${sim[@]}" --engine lockstep
differs "random programs" 45 "in seed [0-9]+.*$arbiter" cosim --programs 100 --no-minimise "${on[@]}"
stack='inside, [^:]*: PC stack of warp [01] .*look at: rtl/compute/rp_pc_stack.v'
differs "a PC stack that pops too late" 35 "$stack" cosim --programs 200 --no-minimise "${on[@]}"
differs "a minimised program" 45 "$arbiter.*saved; again with: $raypool cosim --replay " \
  cosim --programs 100 --save "$folder/saved" "${on[@]}"
differs "a saved program" 45 "$arbiter" cosim --replay "$(echo "$folder"/saved/*.json)" --unit-library "$machine"

# What can be read once only.
kernel='again: isub r1, r1, 1
igt p1, r1, 0
@p1 jany again
exit'
differs "a kernel from a pipe" 52 "can be read once only.*instruction in this cycle in the RTL.*look at: rtl/" \
  run <(echo "$kernel") --engine lockstep "${on[@]}"

if [ "$before" != "$(cd "$folder/frame" && ls -A && cksum ./*)" ]; then
  failures=$((failures + 1))
  echo "FAILED: the earlier frame's results are not what they were: $(ls -A "$folder/frame")"
fi
[ "$failures" = 0 ] || { echo "$failures cases failed"; exit 1; }
