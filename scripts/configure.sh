#!/bin/bash
# Configures the build folder: scripts/configure.sh BUILD TESTS [OPTION]..., TESTS = ON or OFF. ON once
# stays ON; nothing is done when it fits. A folder that was made for another checkout is configured again. A second one
# in the same folder waits. OPTION: for CMake, of a folder that does not exist yet.
set -eu -o pipefail
build=$1 tests=$2
shift 2
cache=$build/CMakeCache.txt
# shellcheck source=scripts/build_place.bash
. "$(dirname "$0")/build_place.bash"
kept=()
mkdir -p "$build"
take_turn "$build"
leave_place "$build"
[[ " ${kept[*]} " != *' -DRAYPOOL_TESTS:BOOL=ON '* ]] || tests=ON
if [ -f "$cache" ] && [ -f "$build/build.ninja" ]; then
  # Ninja would configure again by itself, but first build by the old rules what the configuration depends on.
  changed=$(find CMakeLists.txt cmake cpp_model sim studies program tb -newer "$build/build.ninja" \
    \( -name CMakeLists.txt -o -name '*.cmake' \))
  if [ -z "$changed" ]; then
    [ "$tests" = ON ] && grep -q '^RAYPOOL_TESTS:BOOL=OFF' "$cache" || exit 0
  fi
  [ "$tests" = ON ] || tests=$(sed -n 's/^RAYPOOL_TESTS:BOOL=//p' "$cache")
fi
log=$build/configure.log
cmake -S . -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release "${kept[@]}" -DRAYPOOL_TESTS="$tests" "$@" \
  > "$log" 2>&1 9>&- || { cat "$log" >&2; exit 1; }
touch "$build/build.ninja"
