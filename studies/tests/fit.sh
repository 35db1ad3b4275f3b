#!/bin/bash
# What raypool fit leaves is a machine like any: studies/tests/fit.sh RAYPOOL
# It draws the picture of the kernels as C++, byte for byte, in the model and, hardware against model, in lockstep; the
# same frame needs no less, and what needs more is refused.
set -u -o pipefail
raypool=$(realpath "$1")
cd "$(dirname "$0")/../.." || exit 1
. scripts/tests/expect.bash
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

# fits SCENE OPTION...: the fitted machine, and a run of it, in the folder SCENE.
fits() {
  local scene=$1 what="$*"; shift
  local frame=("$scene" --size 24x16 "$@" --quiet)
  local machine=$folder/$scene.json
  expect "$what: fitted" 0 "byte for byte" "$raypool" fit "${frame[@]}" --config 2w2c \
    --out "$machine" --json "$folder/$scene-found.json"
  expect "$what: the fitted machine draws it" 0 "results" "$raypool" sim "${frame[@]:0:$((${#frame[@]} - 1))}" \
    --config "$machine" --engine model --out "$folder/$scene"
  "$raypool" sim "${frame[@]}" --config 2w2c --engine native --out "$folder/$scene-native"
  expect "$what: the same picture" 0 "" cmp "$folder/$scene/image.png" "$folder/$scene-native/image.png"
  expect "$what: the cycles are those that fit has printed" 0 "" python3 - "$folder/$scene-found.json" \
    "$folder/$scene/report.json" <<'CHECK'
import json, sys
found, report = (json.load(open(path)) for path in sys.argv[1:])
assert found["changes"] and found["cycles"]["fitted"] <= found["cycles"]["most"], found["cycles"]
assert report["cycles"] == found["cycles"]["fitted"], (report["cycles"], found["cycles"])
assert report["configuration"] == found["fitted"], "the file has another machine"
CHECK
  expect "$what: fitted again it loses nothing more" 0 "nothing: the frame needs all of it" "$raypool" fit \
    "${frame[@]}" --config "$machine" --slower 0 --out "$folder/again.json"
}
fits room --depth 3 --detail 0.02
fits cornell --depth 1

# The hardware of the one of them that has less.
expect "the fitted Cornell box has a Verilated unit" 0 "" env RAYPOOL="$raypool" scripts/unit.sh "$folder/cornell.json"
expect "hardware and model agree in every cycle" 0 " 0 differences" "$raypool" sim cornell --size 24x16 --depth 1 \
  --config "$folder/cornell.json" --engine lockstep --out "$folder/lockstep"
expect "... on the same picture" 0 "" cmp "$folder/lockstep/image.png" "$folder/cornell-native/image.png"
expect "random programs run on it" 0 " 0 differences" "$raypool" cosim --config "$folder/cornell.json" --programs 20 \
  --seed 1 --quiet --save "$folder"

# A shader set, on a machine with what its shaders need alone.
set=cpp_model/shader/cases/reflections
shaded=(cornell --size 16x12 --depth 4 --shaders "$set" --quiet)
expect "a shader set is fitted" 0 "cases/reflections: what it needs of 2w2c" "$raypool" fit "${shaded[@]}" \
  --config 2w2c --out "$folder/shaded.json" --json "$folder/shaded-found.json"
expect "... which the JSON has" 0 '"shaders": "cpp_model/shader/cases/reflections"' cat "$folder/shaded-found.json"
expect "... to a machine whose rays come back" 0 '"miss_records": true' cat "$folder/shaded.json"
for machine in 2w2c "$folder/shaded.json"; do
  "$raypool" sim "${shaded[@]}" --config "$machine" --engine model --out "$folder/shaded-$(basename "$machine" .json)"
done
expect "... that draws the same picture" 0 "" cmp "$folder/shaded-2w2c/image.png" "$folder/shaded-shaded/image.png"
expect "... in the cycles that fit has printed" 0 "" python3 - "$folder/shaded-found.json" \
  "$folder/shaded-shaded/report.json" <<'CHECK'
import json, sys
found, report = (json.load(open(path)) for path in sys.argv[1:])
assert report["cycles"] == found["cycles"]["fitted"], (report["cycles"], found["cycles"])
CHECK
expect "another set needs more words of a hit" 1 "the ray kernels need 20 words of an intersection" "$raypool" \
  sim cornell --size 16x12 --shaders path --config "$folder/shaded.json" --set chip.miss_records=false \
  --out "$folder/shaded-path"

# One mirror more than the machine was fitted to; a machine without what a kernel has; the kernels of other programs.
"$raypool" scene cornell --detail 0.1 --write-obj "$folder/mirror.obj" > "$folder/scene.txt"
sed 's/mirror/matt/' "$folder/mirror.obj" > "$folder/matt.obj"
sed 's/^Ks .*/Ks 0 0 0/' "$folder/mirror.mtl" > "$folder/matt.mtl"
expect "a scene without a mirror is fitted at depth 3" 0 "no material reflects" "$raypool" fit "$folder/matt.obj" \
  --config 2w2c --size 8x8 --quiet --out "$folder/matt.json"
for engine in native functional model lockstep; do
  expect "a mirror is refused by engine $engine" 1 "floor' reflects, and depth 3 casts reflections" "$raypool" sim \
    "$folder/mirror.obj" --config "$folder/matt.json" --size 8x8 --engine "$engine" --out "$folder/mirror"
done
expect "... and nothing is left" 1 "" test -e "$folder/mirror"
expect "... by a further fit too" 1 "(chip.reflections)" "$raypool" fit "$folder/mirror.obj" --size 8x8 \
  --config "$folder/matt.json" --out "$folder/mirror.json"
expect "at depth 1 it is drawn" 0 results "$raypool" sim "$folder/mirror.obj" --config "$folder/matt.json" --size 8x8 \
  --depth 1 --out "$folder/mirror"
expect "a kernel with an instruction that is lacking is refused" 1 "kernel cast_secondary has frsqrt (instruction" \
  "$raypool" sim cornell --config "$folder/room.json" --set alus.slw.without=frsqrt --size 8x8 --out "$folder/lacking"
expect "... with what to do" 1 "take it off alus.int.without" "$raypool" run saxpy --config "$folder/matt.json"

# Subnormal numbers, which neither frame has: in what a scene is made of, and later, in a product of two reflectances.
sed '0,/^v /s/^v [^ ]*/v 1e-39/' "$folder/matt.obj" > "$folder/vertex.obj"
sed 's/^Ks .*/Ks 1e-30 1e-30 1e-30/; s/^Kd .*/Kd 1e-10 1e-10 1e-10/' "$folder/mirror.mtl" > "$folder/faint.mtl"
sed 's/mirror/faint/' "$folder/mirror.obj" > "$folder/faint.obj"
expect "a frame without subnormal numbers needs none" 0 '"none"' grep subnormals "$folder/matt.json" "$folder/room.json"
for engine in native model lockstep; do
  expect "a vertex at 1e-39 is refused by engine $engine" 1 \
    "vertex 0, a corner of triangle 0 (material 'floor'), has the coordinate x 1e-39, a subnormal number" \
    "$raypool" sim "$folder/vertex.obj" --config "$folder/matt.json" --size 8x8 --engine "$engine" \
    --out "$folder/vertex"
done
expect "... and nothing is left" 1 "" test -e "$folder/vertex"
echo '{"eye": [2.75, 2.75, 10], "direction": [0, 0, -1],
  "light": {"position": [2.9, 5, 6.2], "color": [1e-40, 1, 1]}}' > "$folder/dark.json"
expect "a light that is nearly black is refused" 1 "the light has the color r 1e-40" "$raypool" sim "$folder/matt.obj" \
  --config "$folder/matt.json" --view "$folder/dark.json" --size 8x8 --out "$folder/dark"
expect "a fit to such a scene keeps them" 0 "results" "$raypool" fit "$folder/vertex.obj" --config 2w2c --size 8x8 \
  --quiet --out "$folder/vertex.json"
expect "... in the file" 1 "" grep subnormals "$folder/vertex.json"
for engine in functional model; do
  expect "a product that is one stops the frame in engine $engine" 1 \
    "subnormal number arose in kernel cast_secondary at 'f" "$raypool" sim "$folder/faint.obj" \
    --config "$folder/room.json" --size 8x8 --engine "$engine" --out "$folder/faint"
done
expect "... with what to do" 1 "draw with --set arithmetic.subnormals=ieee, or fit" "$raypool" sim "$folder/faint.obj" \
  --config "$folder/room.json" --size 8x8 --out "$folder/faint"
expect "... which draws it" 0 results "$raypool" sim "$folder/faint.obj" --config "$folder/room.json" --size 8x8 \
  --set arithmetic.subnormals=ieee --out "$folder/faint"

# Infinities and NaNs are counted: no frame above has one. In a scene of 1e-25 squares of distances vanish.
expect "no ordinary frame has infinities or NaNs" 0 "[0, 0]" python3 - "$folder/room-found.json" \
  "$folder/cornell-found.json" <<'CHECK'
import json, sys
specials = [json.load(open(path))["specials"] for path in sys.argv[1:]]
assert all(each["operations"] > 1000 and each["instructions"] > 50 for each in specials), specials
print([len(each["places"]) for each in specials])
CHECK
awk '/^v / { $2 = $2 "e-25"; $3 = $3 "e-25"; $4 = $4 "e-25" } { print }' "$folder/mirror.obj" > "$folder/tiny.obj"
echo '{"eye": [2.75e-25, 2.75e-25, 1e-24], "direction": [0, 0, -1],
  "light": {"position": [2.9e-25, 5e-25, 6.2e-25], "color": [1, 1, 1]}}' > "$folder/tiny-view.json"
expect "an infinity is reported with kernel and instruction" 0 ": frsqrt r" \
  "$raypool" fit "$folder/tiny.obj" --view "$folder/tiny-view.json" --config 2w2c --size 8x8 --quiet \
  --out "$folder/tiny.json"

# Input that cannot be used.
small=(fit cornell --size 8x8 --config 1w1c --quiet)
expect "a share that is none is refused" 1 "--slower is 'much'" "$raypool" "${small[@]}" --slower much
expect "a negative share is refused" 1 "--slower is '-1%'" "$raypool" "${small[@]}" --slower=-1%
expect "a place that cannot be written is refused" 1 "cannot write '$folder/none/x.json'" "$raypool" "${small[@]}" \
  --out "$folder/none/x.json"
expect "a depth out of range is refused" 1 "depth is 0" "$raypool" "${small[@]}" --depth 0

[ "$failures" = 0 ]
