#!/bin/bash
# raypool explore: the front of a small space, the same in every run, in its table and its file; what it refuses.
# Called with the program.
set -euo pipefail
raypool=$1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
fail() {
  echo "$1" >&2
  exit 1
}

# All 24 combinations: the front must be that of the model, machine by machine.
explore() {
  "$raypool" explore cornell --size 32x32 --depth 1 --config 4w4c --quiet --out "$1" "${@:2}" \
    --vary warps=2,4 --vary lanes=2,4 --vary units=1,2 --vary alus.int.count=1 --vary alus.flt.count=1,2 \
    --vary slow_lanes=32 --vary triples=false --vary kernel_overlap=false --vary wide_ray_memory=false \
    --vary intersection_words=21 --vary instruction_cache.bytes=4096 --vary data_cache.bytes=8192 \
    --vary chip.policy=thesis,fill --vary chip.shading=kernel --vary chip.ray_pool.size=512 \
    --vary chip.intersection_pool.size=512 --vary chip.hardware_traverser.rays=64 \
    --vary chip.hardware_traverser.lanes=2 --vary chip.hardware_traverser.triangle_pipes=1 \
    --vary chip.hardware_traverser.node_cache_bytes=16384 --vary chip.hardware_traverser.triangle_cache_bytes=16384
}
explore "$folder/one.json" --check 32 --deviations 3 > "$folder/one.txt"
cat "$folder/one.txt"
grep -q '32 machines around 4w4c$' "$folder/one.txt" || fail 'not all combinations'
grep -q '^check     32 of the machines at random, simulated: 0 faster' "$folder/one.txt" ||
  fail 'a machine beats the front'
explore "$folder/two.json" --check 32 --deviations 3 > "$folder/two.txt"
grep -v '"command"\|one.json\|two.json' "$folder/one.json" > "$folder/one"
grep -v '"command"\|one.json\|two.json' "$folder/two.json" > "$folder/two"
cmp "$folder/one" "$folder/two" || fail 'another front in the second run'

# The cycles are those of raypool sim.
/usr/bin/python3 - "$folder/one.json" "$raypool" << 'END'
import json
import subprocess
import sys

found = json.load(open(sys.argv[1]))
front = [row for row in found["machines"] if row["front"]]
assert len(front) > 1, front
row = front[-1]
fixed = ("slow_lanes=32 chip.hardware_traverser.rays=64 chip.hardware_traverser.lanes=2 "
         "chip.hardware_traverser.triangle_pipes=1 chip.hardware_traverser.node_cache_bytes=16384 "
         "chip.hardware_traverser.triangle_cache_bytes=16384 ")
command = [sys.argv[2], "sim", "cornell", "--size", "32x32", "--depth", "1", "--config", "4w4c", "--engine", "model",
           "--units", str(row["units"]), "--set", fixed + row["changes"], "--json", "--quiet", "--out", "/dev/null"]
command[command.index("/dev/null")] = sys.argv[1] + ".out"
cycles = json.loads(subprocess.run(command, check=True, stdout=subprocess.PIPE).stdout)["cycles"]
assert cycles == row["cycles"], (cycles, row)
END

# Its plot.
plot=$(dirname "$0")/../explore_plot.py
"$plot" "$folder/one.json" "$folder/one.svg" > "$folder/out"
grep -q 'front, simulated, [1-9]' "$folder/one.svg" || fail 'a plot without the front'
echo '{}' > "$folder/wrong.json"
if "$plot" "$folder/wrong.json" 2> "$folder/out"; then fail 'a plot of nothing'; fi
grep -q 'is not what raypool explore writes' "$folder/out" || fail "$(cat "$folder/out")"

# Machines at random and their neighbours.
"$raypool" explore cornell --size 16x16 --depth 1 --machines 60 --quiet --out "$folder/few.json" > "$folder/few.txt"
grep -q '^cornell, .*: [1-6][0-9] machines around best_8w8c$' "$folder/few.txt" || fail "$(cat "$folder/few.txt")"

refuses() {
  local words=$1
  shift
  if "$raypool" explore cornell --size 16x16 --quiet --out "$folder/none.json" "$@" > "$folder/out" 2>&1; then
    fail "not refused: $*"
  fi
  grep -qF -- "$words" "$folder/out" || fail "$* is refused with: $(cat "$folder/out")"
  [ ! -e "$folder/none.json" ] || fail "$* leaves a file"
}
refuses "did you mean warps" --vary warp=4,8
refuses "--vary is 'warps': give a field and its values, warps=4,8,16" --vary warps
refuses "a chip has 1, 2 or 4" --vary units=3
refuses "one value of it for all machines" --vary chip.traverser=static,hardware
refuses "one value of it for all machines" --vary arithmetic.fma=false,true
refuses "leave out chip.traverser=static" --set chip.traverser=static
refuses "the table of areas cannot be read" --areas "$folder/no.json"
echo '{"blocks": 3}' > "$folder/wrong.json"
refuses "is not a table of areas" --areas "$folder/wrong.json"
refuses "--machines" --machines 0
echo 'explore: all as expected'
