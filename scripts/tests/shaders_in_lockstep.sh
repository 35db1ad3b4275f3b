#!/bin/bash
# Shader sets on the Verilog: pictures of native, functional and lockstep are the same byte for byte, and lockstep finds
# no difference.
#   scripts/tests/shaders_in_lockstep.sh RAYPOOL unit|chip LIBRARIES [large]
# unit: on the Verilated unit of tb/mutants/2w2c.json beside RAYPOOL. chip: on the smallest of chips; they
# are Verilated into the folder LIBRARIES, unless they are there. large: more sets, larger pictures, and a chip with its
# traverser inside.
set -eu -o pipefail
raypool=$(realpath "$1") boundary=$2 size=${4:-small}
mkdir -p "$3"
libraries=$(realpath "$3")
cd "$(dirname "$0")/../.."
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

# on_unit: draws on the Verilated unit.
on_unit() {
  machine=(--config tb/mutants/2w2c.json --set chip.traverser=static)
  library=()
}

# verilate unit|chip NAME SETTINGS UNITS: of a machine, which then draws.
verilate() {
  local kind=$1 name=$2 of_chip=() top=multiprocessor parameters
  # In a file, since sim refuses settings of what a chip does not have.
  "$raypool" config 1w1c --set "$3" --json > "$folder/$name.json"
  machine=(--config "$folder/$name.json" --units "$4")
  [ "$kind" = unit ] || { of_chip=(--chip --units "$4"); top=chip; }
  parameters=$("$raypool" config "$folder/$name.json" --verilog-parameters "${of_chip[@]}")
  [ "$kind" = chip ] || parameters+=" UNITS=$4"
  mkdir -p "$libraries/$name"
  # shellcheck disable=SC2086
  flock "$libraries/$name/.lock" scripts/verilate.sh "$libraries/$name" --top $top --quick $parameters \
    > "$folder/verilate.log" || { cat "$folder/verilate.log"; exit 1; }
  library=(--unit-library "$libraries/$name/libraypool_$kind.so")
}

# on_units UNITS: draws on so many, whose caches are large enough that what they hold grows old.
on_units() {
  verilate unit "units_2w2c_$1" "warps=2 lanes=2 sharing=true chip.miss_records=true \
    chip.traverser=static" "$1"
}

# on_chip TRAVERSER [returns|units]: draws on a chip that has of everything one; or one whose rays come back if they
# meet nothing, too; or on such a chip with two units. Tests of tb/rtl Verilate the first ones too.
on_chip() {
  local name units=1 settings="chip.traverser=$1 instruction_cache.bytes=512 data_cache.bytes=512 data_cache.mshrs=1"
  settings+=" chip.held_limit=1 chip.ray_pool.size=1 chip.intersection_pool.size=1 chip.memory.queue=1"
  settings+=" chip.hardware_traverser.node_cache_mshrs=1 chip.hardware_traverser.triangle_cache_mshrs=1"
  if [ "$1" = static ]; then
    name=chip_1w1c
    settings+=" chip.ray_pool.overhead=1 chip.intersection_pool.overhead=1 chip.memory.latency=6"
    settings+=" chip.memory.cycles_per_beat=1"
  else
    name=chip_traverser_1w1c
    settings+=" chip.memory.latency=20 chip.hardware_traverser.lanes=1 chip.hardware_traverser.rays=1"
    settings+=" chip.hardware_traverser.triangle_pipes=1 chip.hardware_traverser.stack_entries=8"
    settings+=" chip.hardware_traverser.cache_banks=1"
    settings+=" chip.hardware_traverser.node_cache_bytes=512 chip.hardware_traverser.triangle_cache_bytes=512"
    settings+=" chip.hardware_traverser.node_cache_ways=2 chip.hardware_traverser.triangle_cache_ways=2"
  fi
  if [ $# -gt 1 ]; then
    name+=_$2
    settings+=" chip.miss_records=true"
  fi
  if [ "${2:-}" = units ]; then
    units=2
    settings=${settings/data_cache.bytes=512/data_cache.bytes=8192 sharing=true}
  fi
  verilate chip "$name" "$settings" "$units"
}

# draw SCENE SET SIZE DEPTH SAMPLES
draw() {
  local scene=$1 set=$2 engine words
  local folder_of=shaders/$set
  [ -d "$folder_of" ] || folder_of=cpp_model/shader/cases/$set
  words=(--scene "$scene" --detail 0.05 --shaders "$folder_of" --size "$3" --depth "$4" --samples "$5"
    "${machine[@]}")
  for engine in native functional lockstep; do
    beside=()
    [ $engine != lockstep ] || beside=(--boundary "$boundary" "${library[@]}")
    "$raypool" sim "${words[@]}" --engine $engine "${beside[@]}" --out "$folder/$engine" --quiet \
      2> "$folder/said" || { cat "$folder/said"; exit 1; }
    cmp "$folder/native/image.png" "$folder/$engine/image.png" ||
      { echo "FAILED: $set of $scene: $engine and native draw different pictures"; exit 1; }
  done
  python3 - "$folder/lockstep/report.json" "$set of $scene, $3" <<'END'
import json
import sys

report = json.load(open(sys.argv[1]))
found = report["lockstep"]
assert found["differences"] == 0 and found["cycles"] >= report["cycles"] > 1000, report
assert found["frame_contributions"] == report["contributions"] > 0, report
print(f"{sys.argv[2]}: {found['cycles']} cycles, 0 differences")
END
}

features=examples/scenes/features.gltf
draw_small() {
  draw cornell whitted 8x6 2 1
  draw $features preview 6x4 2 1
  draw cornell path 4x3 3 1
}
draw_large() {
  draw cornell whitted 16x12 4 1
  draw $features whitted 16x12 3 1
  draw $features ao 16x12 1 2
  draw $features preview 16x12 3 1
  draw $features debug 16x12 1 1
  draw $features path 6x4 4 2
}
# Shaders that wait for their rays.
wait_small() {
  draw cornell shadow_inside 6x4 1 1
}
# Those that keep a record of their paths, which go on in any unit.
wait_units() {
  draw cornell reflections 16x12 1 1
  draw $features nested 8x6 4 1
}
wait_large() {
  draw cornell triangle 16x12 1 1
  draw $features reflections 12x8 1 1
  draw $features shadow_inside 16x12 1 1
  draw cornell bounces 6x4 1 1
  draw cornell groups 12x8 1 1
  draw $features cutouts 12x8 1 1
  draw $features table 6x4 1 1
  draw $features nested 8x6 4 1
}
if [ "$boundary" = unit ]; then
  on_unit
  "draw_$size"
  "wait_$size"
  on_units 2
  draw cornell bounces 4x3 1 1
  [ "$size" = small ] || { on_units 4; wait_units; }
elif [ "$size" = small ]; then
  on_chip static
  draw_small
  on_chip hardware returns
  wait_small
else
  on_chip static
  draw_large
  on_chip hardware
  draw_small
  on_chip hardware returns
  wait_large
  on_chip hardware units
  wait_units
fi
