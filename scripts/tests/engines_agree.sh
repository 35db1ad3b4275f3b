#!/bin/bash
# All engines draw the same picture, byte for byte, and lockstep finds no difference:
#   scripts/tests/engines_agree.sh RAYPOOL CONFIG DEPTH [UNITS]
# Needs the Verilated device of CONFIG and UNITS (default 1) beside RAYPOOL.
set -eu -o pipefail
raypool=$(realpath "$1") config=$2 depth=$3 units=${4:-1}
cd "$(dirname "$0")/../.."
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

for engine in native functional model rtl lockstep; do
  "$raypool" sim --scene cornell --size 40x24 --config "$config" --depth "$depth" --units "$units" --engine "$engine" --out "$folder/$engine" --quiet
  cmp "$folder/native/image.png" "$folder/$engine/image.png"
done
report=$folder/lockstep/report.json
grep -qE '"differences": 0\b' "$report" || { echo "FAILED: lockstep reports differences:"; cat "$report"; exit 1; }
grep -qE '"instructions": [1-9][0-9]{3,}' "$report" || { echo "FAILED: lockstep compared next to nothing:"; cat "$report"; exit 1; }
# The model takes the hardware's time, also without the hardware beside it.
cycles() { sed -nE 's/^  "cycles": ([0-9]+),$/\1/p' "$folder/$1/report.json"; }
[ -n "$(cycles rtl)" ] && [ "$(cycles rtl)" = "$(cycles model)" ] || { echo "FAILED: rtl took $(cycles rtl) cycles, model $(cycles model)"; exit 1; }
# A picture of one colour would agree too: PNG squeezes it to a few dozen bytes.
[ "$(stat -c %s "$folder/native/image.png")" -gt 400 ] || { echo "FAILED: the picture is empty"; exit 1; }
