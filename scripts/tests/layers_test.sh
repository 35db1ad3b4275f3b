#!/bin/bash
# What simulates, verifies or synthesises the machine may not use a study of it, nor may folders need each other:
# scripts/layers.py refuses it in the sources, cmake/layers.cmake in the targets. Works on a small tree.
set -u -o pipefail
cd "$(dirname "$0")/../.." || exit 1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
# shellcheck source=scripts/tests/expect.bash
. scripts/tests/expect.bash
mkdir -p "$folder"/{cpp_model/arith,sim/chip,tb/unit,studies/fit,scripts,program}
touch "$folder/cpp_model/arith/arith.hpp" "$folder/sim/chip/chip.hpp" "$folder/studies/fit/fit.hpp"
touch "$folder/studies/sweep.py" "$folder/scripts/synth.py"
echo '#include "chip/chip.hpp"' > "$folder/studies/fit/needs.cpp"
echo 'import synth' > "$folder/studies/pareto.py"
layers() { scripts/layers.py "$folder"; }
# wrong FILE TEXT WHAT: with this file the check fails and prints WHAT.
wrong() {
  echo "$2" > "$folder/$1"
  expect "$1 with $2" 1 "$3" layers
  rm "$folder/$1"
}

expect "studies stand on the machine" 0 "1 includes and 1 imports" layers
wrong sim/chip/board.cpp '#include "fit/fit.hpp"' "sim/chip/board.cpp uses studies/fit/fit.hpp: sim may not use studies"
wrong tb/unit/a_test.cpp '#include "fit/fit.hpp"' "tb may not use studies"
wrong cpp_model/arith/a.hpp '#include "chip/chip.hpp"' "cpp_model may not use sim"
wrong scripts/lint.py 'from sweep import table' "scripts/lint.py uses studies/sweep.py: scripts may not use studies"
mkdir "$folder/sim/scene"
echo '#include "scene/scene.hpp"' > "$folder/sim/chip/chip.hpp"
wrong sim/scene/scene.hpp '#include "chip/chip.hpp"' "folders that need each other: "

# project LIBRARY: what sim links.
project() {
  cat > "$folder/CMakeLists.txt" << END
cmake_minimum_required(VERSION 3.25)
project(layers LANGUAGES NONE)
include($PWD/cmake/layers.cmake)
raypool_layer(cpp_model)
raypool_layer(sim cpp_model)
raypool_layer(studies cpp_model sim)
raypool_check_layers()
END
  echo 'add_library(arith INTERFACE)' > "$folder/cpp_model/CMakeLists.txt"
  printf 'add_library(chip INTERFACE)\ntarget_link_libraries(chip INTERFACE %s)\n' "$1" > "$folder/sim/CMakeLists.txt"
  printf 'add_library(fit INTERFACE)\ntarget_link_libraries(fit INTERFACE chip)\n' > "$folder/studies/CMakeLists.txt"
  cmake -S "$folder" -B "$folder/build"
}
expect "targets of studies link those of the machine" 0 "Configuring done" project arith
expect "a target of the machine links a study" 1 "chip uses fit of studies" project fit
[ "$failures" = 0 ]
