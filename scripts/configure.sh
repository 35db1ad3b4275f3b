#!/bin/bash
# Configures the build folder: scripts/configure.sh BUILD TESTS [OPTION]..., TESTS = ON or OFF. ON once stays ON; nothing is done when it fits.
# OPTION: for CMake, of a folder that does not exist yet.
set -eu -o pipefail
build=$1 tests=$2
shift 2
cache=$build/CMakeCache.txt
if [ -f "$cache" ] && [ -f "$build/build.ninja" ]; then
  [ "$tests" = ON ] && grep -q '^RAYPOOL_TESTS:BOOL=OFF' "$cache" || exit 0
fi
mkdir -p "$build"
log=$build/configure.log
cmake -S . -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DRAYPOOL_TESTS="$tests" "$@" > "$log" 2>&1 || { cat "$log" >&2; exit 1; }
