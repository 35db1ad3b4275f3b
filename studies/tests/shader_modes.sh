#!/bin/bash
# What raypool numerics --shaders says of a mode is what that machine draws: studies/tests/shader_modes.sh RAYPOOL
set -u -o pipefail
raypool=$(realpath "$1")
cd "$(dirname "$0")/../.." || exit 1
. scripts/tests/expect.bash
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

frame=(cornell --shaders preview --size 24x16 --samples 2 --quiet)
"$raypool" numerics "${frame[@]}" --config 2w2c --out "$folder/modes" > "$folder/table.txt"
drawn() { # NAME OPTION...: the same frame, by the machine's own code or as C++
  "$raypool" sim "${frame[@]}" --config 2w2c --out "$folder/$1" "${@:2}"
}
drawn full --engine native
drawn flush-newton0 --engine functional --set "arithmetic.subnormals=flush arithmetic.slow_unit=newton0"
drawn ieee-exact-11 --engine functional --set arithmetic.significand=11
drawn ieee-newton1-fma --engine native --set "arithmetic.slow_unit=newton1 arithmetic.fma=true alus.flt.depth=5"
"$raypool" sim cornell --shaders preview --size 32x32 --quiet --config 2w2c --engine model --out "$folder/timed" \
  --traverser static --set arithmetic.significand=11
for mode in flush-newton0 ieee-exact-11 ieee-newton1-fma; do
  "$raypool" compare "$folder/full" "$folder/$mode" > "$folder/$mode.txt"
done
expect "figures are those of the machines' pictures" 0 "the same" python3 - "$folder" <<'CHECK'
import json
import re
import sys

folder = sys.argv[1]
found = {row["mode"]: row for row in json.load(open(f"{folder}/modes/numerics.json"))["modes"]}
assert len(found) == 20 and all(row["pixels"] == 24 * 16 for row in found.values()), found
full = found["ieee-exact"]
assert full["psnr_db"] is None and full["off_by_one"] == full["off_by_more"] == 0 and full["light"] == 1, full
assert found["ieee-exact-11"]["off_by_more"] > 0 and abs(found["ieee-exact-11"]["light"] - 1) < 0.5, found
for mode in ("flush-newton0", "ieee-exact-11", "ieee-newton1-fma"):
    text = open(f"{folder}/{mode}.txt").read()
    differ = int(re.search(r"^picture +(?:(\d+) of 384|the same)", text, re.M)[1] or 0)
    assert differ == found[mode]["off_by_one"] + found[mode]["off_by_more"], (mode, text, found[mode])
report = json.load(open(f"{folder}/timed/report.json"))
assert abs(report["cycles"] / report["rays"] - found["ieee-exact-11"]["cycles_per_ray"]) < 1e-9, report["cycles"]
assert found["ieee-exact-fma"]["instructions"] < full["instructions"], found
print("the same")
CHECK
expect "a scene without shaders" 1 "leave --scene out, or give --shaders too" "$raypool" numerics cornell --quiet
expect "samples without shaders" 1 "leave --samples out" "$raypool" numerics --samples 2 --quiet
expect "shaders of the catalogue" 1 "leave --extremes, --catalogue and --configurations out" "$raypool" numerics \
  --shaders preview --extremes
expect "no such mode" 1 "there is no arithmetic mode 'ieee'" "$raypool" numerics --shaders preview --mode ieee
expect "no such set" 1 "nosuchset" "$raypool" numerics --shaders nosuchset --quiet
[ "$failures" = 0 ]
