#!/bin/bash
# Random shader sets that wait for their rays: native, functional, model and lockstep draw the same picture of each, and
# lockstep finds no difference.
#   scripts/tests/random_shaders.sh RAYPOOL RAYPOOL_RANDOM_SET SEED...
# On one compute unit, the Verilated one of tb/mutants/2w2c.json beside RAYPOOL.
set -eu -o pipefail
raypool=$(realpath "$1") generator=$(realpath "$2")
seeds=("${@:3}")
cd "$(dirname "$0")/../.."
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

# draw SEED ENGINE: its picture, if the set can be drawn at all.
draw() {
  "$raypool" sim --scene examples/scenes/features.gltf --shaders "$folder/set" --config tb/mutants/2w2c.json \
    --set chip.traverser=static --size 4x3 --depth 3 --engine "$2" --out "$folder/$2" --quiet 2> "$folder/said" ||
    { echo "FAILED: seed $1, $2: $(cat "$folder/said")"; exit 1; }
  cmp "$folder/native/image.png" "$folder/$2/image.png" ||
    { echo "FAILED: seed $1: $2 and native draw different pictures"; exit 1; }
}

pictures=()
for seed in "${seeds[@]}"; do
  rm -rf "$folder/set"
  "$generator" "$seed" "$folder/set"
  for engine in native functional model lockstep; do draw "$seed" $engine; done
  pictures+=("$(sha256sum < "$folder/native/image.png")")
  grep -q '"differences": 0' "$folder/lockstep/report.json" || { echo "FAILED: seed $seed: differences"; exit 1; }
done
several=$(printf '%s\n' "${pictures[@]}" | sort -u | wc -l)
[ $((2 * several)) -ge ${#seeds[@]} ] || { echo "FAILED: ${#seeds[@]} sets draw only $several pictures"; exit 1; }
echo "${#seeds[@]} sets: $several pictures, each the same with native, functional, model and lockstep"
