#!/bin/bash
# Whoever plays the whole chip draws the kernels' picture in the same cycles, with the same figures in the report:
#   scripts/tests/chips_agree.sh RAYPOOL CONFIG
# Needs the Verilated chip of CONFIG beside RAYPOOL.
set -eu -o pipefail
raypool=$(realpath "$1") config=$2
cd "$(dirname "$0")/../.."
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

# figures FOLDER: all but what says who has drawn it, and how fast.
figures() {
  python3 - "$1/report.json" <<'END'
import json
import sys

report = json.load(open(sys.argv[1]))
assert report["whole_chip"] and report["cycles"] > 10000 and report["contributions"] > 0, report
for key in ("command", "engine", "lockstep", "wall_seconds", "simulation_seconds", "simulated_per_second"):
    report.pop(key, None)
print(json.dumps(report, indent=1))
END
}

for depth in 1 4; do
  "$raypool" sim cornell --size 40x24 --depth "$depth" --engine native --out "$folder/native" --quiet
  for chip in model rtl lockstep; do
    "$raypool" sim cornell --size 40x24 --depth "$depth" --config "$config" --chip "$chip" --out "$folder/$chip" --quiet
    cmp "$folder/native/image.png" "$folder/$chip/image.png"
    figures "$folder/$chip" > "$folder/$chip.json"
    cmp "$folder/model.json" "$folder/$chip.json"
  done
  report=$folder/lockstep/report.json
  cycles=$(sed -nE 's/^  "cycles": ([0-9]+),$/\1/p' "$report")
  python3 -c 'import json, sys
lockstep = json.load(open(sys.argv[1]))["lockstep"]
assert lockstep["differences"] == 0 and lockstep["cycles"] >= int(sys.argv[2]), lockstep' "$report" "$cycles"
done

# With the traverser inside, nothing but memories and host is around the chip; a hit is what that traverser says.
for depth in 1 4; do
  inside=(cornell --size 40x24 --depth "$depth" --config "$config" --traverser hardware --set chip.culling=true --quiet)
  "$raypool" sim "${inside[@]}" --engine native --out "$folder/native"
  "$raypool" sim "${inside[@]}" --engine functional --out "$folder/functional"
  "$raypool" sim "${inside[@]}" --chip model --out "$folder/inside"
  cmp "$folder/native/image.png" "$folder/functional/image.png"
  cmp "$folder/native/image.png" "$folder/inside/image.png"
  figures "$folder/inside" > "$folder/inside.json"
  python3 -c 'import json, sys
chip, native = (json.load(open(path)) for path in sys.argv[1:])
assert "traverser_batches" not in chip and "traversal" not in chip, chip
for key in ("rays_by_kind", "rays_without_weight", "rays_in_vain", "rays_left_out", "rays_that_end", "contributions"):
    assert chip[key] == native[key], (key, chip[key], native[key])' \
    "$folder/inside.json" "$folder/native/report.json"
done
