#!/bin/bash
# All engines draw the same picture, byte for byte, and lockstep finds no difference:
#   scripts/tests/engines_agree.sh RAYPOOL CONFIG DEPTH [UNITS]
# Needs the Verilated device of CONFIG and UNITS (default 1) beside RAYPOOL.
set -eu -o pipefail
raypool=$(realpath "$1") config=$2 depth=$3 units=${4:-1}
cd "$(dirname "$0")/../.."
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

# draw SCENE SIZE FOLDER [TRAVERSER]: the picture, and what became of the rays, as every engine has it.
draw() {
  for engine in native functional model rtl lockstep; do
    "$raypool" sim --scene "$1" --size "$2" --config "$config" --depth "$depth" --units "$units" --engine "$engine" \
      --traverser "${4:-static}" --out "$3/$engine" --quiet
    cmp "$3/native/image.png" "$3/$engine/image.png"
    cmp <(rays "$3/native") <(rays "$3/$engine") ||
      { echo "FAILED: $engine and native count rays differently"; exit 1; }
  done
}
rays() { sed -n '/^  "rays_by_kind"/,/^  "contributions"/p' "$1/report.json" | grep .; }

# agrees FOLDER: what was drawn there is not empty, and hardware and model took the same cycles for the same.
agrees() {
  local report=$1/lockstep/report.json
  grep -qE '"differences": 0\b' "$report" || { echo "FAILED: lockstep reports differences:"; cat "$report"; exit 1; }
  grep -qE '"instructions": [1-9][0-9]{3,}' "$report" ||
    { echo "FAILED: lockstep compared next to nothing:"; cat "$report"; exit 1; }
  # The model takes the hardware's time, also without the hardware beside it.
  [ -n "$(cycles "$1/rtl")" ] && [ "$(cycles "$1/rtl")" = "$(cycles "$1/model")" ] ||
    { echo "FAILED: rtl took $(cycles "$1/rtl") cycles, model $(cycles "$1/model")"; exit 1; }
  # A picture of one colour would agree too: PNG squeezes it to a few dozen bytes.
  [ "$(stat -c %s "$1/native/image.png")" -gt 400 ] || { echo "FAILED: the picture is empty"; exit 1; }
}
cycles() { sed -nE 's/^  "cycles": ([0-9]+),$/\1/p' "$1/report.json"; }

for traverser in static modelled; do
  draw cornell 40x24 "$folder/$traverser" "$traverser"
  agrees "$folder/$traverser"
done
cmp "$folder/static/native/image.png" "$folder/modelled/native/image.png"
[ "$(cycles "$folder/static/model")" != "$(cycles "$folder/modelled/model")" ] ||
  { echo "FAILED: both traversers take the same time"; exit 1; }

# Where nothing reflects, no reflection is cast, and the picture is that of depth 1.
"$raypool" scene cornell --detail 0.1 --write-obj "$folder/matt.obj" > "$folder/scene.txt"
sed -i 's/^Ks .*/Ks 0 0 0/' "$folder/matt.mtl"
draw "$folder/matt.obj" 16x12 "$folder/matt"
rays "$folder/matt/lockstep" | grep -q '"reflection": 0,' ||
  { echo "FAILED: reflections in a scene without mirrors:"; rays "$folder/matt/lockstep"; exit 1; }
"$raypool" sim --scene "$folder/matt.obj" --size 16x12 --depth 1 --engine native --out "$folder/direct" --quiet
cmp "$folder/direct/image.png" "$folder/matt/native/image.png"
