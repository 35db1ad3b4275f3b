#!/bin/bash
# All engines draw the same picture, byte for byte, and lockstep finds no difference: scripts/tests/engines_agree.sh RAYPOOL CONFIG DEPTH
# Needs the Verilated unit of CONFIG beside RAYPOOL.
set -eu -o pipefail
raypool=$(realpath "$1") config=$2 depth=$3
cd "$(dirname "$0")/../.."
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

for engine in native functional rtl lockstep; do
  "$raypool" sim --scene cornell --size 40x24 --config "$config" --depth "$depth" --engine "$engine" --out "$folder/$engine" --quiet
  cmp "$folder/native/image.png" "$folder/$engine/image.png"
done
report=$folder/lockstep/report.json
grep -qE '"differences": 0\b' "$report" || { echo "FAILED: lockstep reports differences:"; cat "$report"; exit 1; }
grep -qE '"instructions": [1-9][0-9]{3,}' "$report" || { echo "FAILED: lockstep compared next to nothing:"; cat "$report"; exit 1; }
# A picture of one colour would agree too: PNG squeezes it to a few dozen bytes.
[ "$(stat -c %s "$folder/native/image.png")" -gt 400 ] || { echo "FAILED: the picture is empty"; exit 1; }
