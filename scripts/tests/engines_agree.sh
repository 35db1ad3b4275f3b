#!/bin/bash
# All engines draw the same picture, byte for byte; those with time have the same figures in the report, whatever of the
# chip is Verilog; and lockstep finds no difference:
#   scripts/tests/engines_agree.sh RAYPOOL CONFIG DEPTH [UNITS [chip]]
# Needs the Verilated unit of CONFIG and UNITS (default 1) beside RAYPOOL. With `chip` the whole chip in Verilog draws
# too; it is built here, with each of the traversers.
set -eu -o pipefail
raypool=$(realpath "$1") config=$2 depth=$3 units=${4:-1} whole=${5:-}
cd "$(dirname "$0")/../.."
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

timed=(model rtl-unit lockstep-unit)
[ "$whole" != chip ] || timed+=(rtl-chip lockstep-chip)
static="chip.traverser=static"
# Small, as it may have to be Verilated.
hardware="chip.traverser=hardware chip.culling=true"
for size in lanes=2 triangle_pipes=1 rays=16 cache_banks=2 {node,triangle}_cache_bytes=2048 \
  {node,triangle}_cache_mshrs=8; do
  hardware+=" chip.hardware_traverser.$size"
done

# draw SCENE SIZE FOLDER SET: the picture, and what became of the rays, as every engine has it; those with time agree in
# all but which engine has drawn, and how fast.
draw() {
  local player engine boundary inside
  [ "$whole" != chip ] || RAYPOOL=$raypool scripts/unit.sh "$config" --units "$units" --boundary chip --set "$4"
  for player in native functional "${timed[@]}"; do
    engine=${player%-*} boundary=()
    [ "$player" = "$engine" ] || boundary=(--boundary "${player#*-}")
    "$raypool" sim --scene "$1" --size "$2" --config "$config" --set "$4" --depth "$depth" --units "$units" \
      --engine "$engine" "${boundary[@]}" --out "$3/$player" --quiet
    cmp "$3/native/image.png" "$3/$player/image.png"
    cmp <(rays "$3/native") <(rays "$3/$player") ||
      { echo "FAILED: $player and native count rays differently"; exit 1; }
  done
  for player in "${timed[@]}"; do
    # Of a chip in Verilog the traverser's inside cannot be seen.
    inside=()
    [ "$player" != rtl-chip ] || inside=(traversal ceilings)
    figures "$3/model" "${inside[@]}" > "$folder/model.json"
    figures "$3/$player" "${inside[@]}" > "$folder/player.json"
    diff "$folder"/{model,player}.json || { echo "FAILED: $player and model have other figures"; exit 1; }
  done
}
rays() { sed -n '/^  "rays_by_kind"/,/^  "contributions"/p' "$1/report.json" | grep .; }

# figures FOLDER KEY...: those of the report, without these.
figures() {
  python3 - "$1/report.json" "${@:2}" <<'END'
import json
import sys

report = json.load(open(sys.argv[1]))
assert report["cycles"] > 0, report
for key in ("command", "engine", "boundary", "lockstep", "wall_seconds", "simulation_seconds", "simulated_per_second",
            *sys.argv[2:]):
    report.pop(key, None)
print(json.dumps(report, indent=1))
END
}

# compared FOLDER: what was drawn there is not empty, and lockstep has compared it.
compared() {
  local player
  for player in "${timed[@]}"; do
    [[ $player == lockstep-* ]] || continue
    python3 - "$1/$player/report.json" <<'END'
import json
import sys

report = json.load(open(sys.argv[1]))
found = report["lockstep"]
assert found["differences"] == 0 and found["cycles"] >= report["cycles"] > 1000 and found["kernels"] > 3, report
assert found.get("instructions", 1000) >= 1000 and found["frame_contributions"] == report["contributions"] > 0, report
END
  done
  # A picture of one colour would agree too: PNG squeezes it to a few dozen bytes.
  [ "$(stat -c %s "$1/native/image.png")" -gt 400 ] || { echo "FAILED: the picture is empty"; exit 1; }
}
cycles() { sed -nE 's/^  "cycles": ([0-9]+),$/\1/p' "$1/report.json"; }

draw cornell 40x24 "$folder/static" "$static"
draw cornell 40x24 "$folder/hardware" "$hardware"
compared "$folder/static"
compared "$folder/hardware"
[ "$(cycles "$folder/static/model")" != "$(cycles "$folder/hardware/model")" ] ||
  { echo "FAILED: both traversers take the same time"; exit 1; }

# Where nothing reflects, no reflection is cast, and the picture is that of depth 1.
"$raypool" scene cornell --detail 0.1 --write-obj "$folder/matt.obj" > "$folder/scene.txt"
sed -i 's/^Ks .*/Ks 0 0 0/' "$folder/matt.mtl"
draw "$folder/matt.obj" 16x12 "$folder/matt" "$static"
rays "$folder/matt/model" | grep -q '"reflection": 0,' ||
  { echo "FAILED: reflections in a scene without mirrors:"; rays "$folder/matt/model"; exit 1; }
"$raypool" sim --scene "$folder/matt.obj" --size 16x12 --depth 1 --engine native --set "$static" \
  --out "$folder/direct" --quiet
cmp "$folder/direct/image.png" "$folder/matt/native/image.png"
