#!/bin/bash
# What is installed works away from the checkout: program, library, Debian packages: scripts/tests/package.sh BUILD
# BUILD: the build folder, with the Verilated unit of 4w4c. Nothing of the project is compiled again.
set -eu -o pipefail
build=$(realpath "$1")
root=$(cd "$(dirname "$0")/../.." && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
unset RAYPOOL RAYPOOL_CONFIGS
export HOME=$folder/home XDG_CACHE_HOME=$folder/cache
mkdir "$folder/work" "$HOME"
cd "$folder/work"
fail() {
  echo "FAILED: $*" >&2
  exit 1
}

# draws RAYPOOL: the installed program finds its configurations and draws the picture of the one in BUILD.
"$build/raypool" sim --scene cornell --size 16x16 --config 4w4c_fma --engine model --quiet --out "$folder/reference"
draws() {
  rm -rf raypool-out
  "$1" sim --scene cornell --size 16x16 --config 4w4c_fma --engine model --quiet || fail "$1 does not draw"
  cmp raypool-out/*/image.png "$folder/reference/image.png" || fail "$1 draws another picture"
}

cmake --install "$build" --prefix "$folder/prefix" > "$folder/log" || { cat "$folder/log" >&2; fail "cmake --install"; }
raypool=$folder/prefix/bin/raypool
draws "$raypool"
"$raypool" --version | cmp - <("$build/raypool" --version) || fail "another version"
gzip -dc "$folder/prefix/share/man/man1/raypool.1.gz" | cmp - <("$raypool" man) || fail "another man page"
cmp "$folder/prefix/share/bash-completion/completions/raypool" <("$raypool" completion bash) ||
  fail "another completion"

# Without a unit it names the command that makes one; with it, it runs.
code=0
"$raypool" sim --scene cornell --size 8x8 --config 4w4c --engine lockstep 2> "$folder/error" || code=$?
[ "$code" = 1 ] && grep -qF "build it with raypool unit --config 4w4c" "$folder/error" ||
  fail "no word of raypool unit: $(cat "$folder/error")"
unit=$("$raypool" config 4w4c --unit-library)
[[ $unit == "$XDG_CACHE_HOME"/raypool/* ]] || fail "the unit would be $unit, not in the user's cache"
mkdir -p "$(dirname "$unit")"
built=$(dirname "$("$build/raypool" config 4w4c --unit-library)")
cp "$built"/libraypool_unit.{so,stamp} "$(dirname "$unit")"
# verilate.sh takes the copied unit for its own only if every file that it is made from is installed, and the same.
"$raypool" unit --config 4w4c > "$folder/text" || fail "raypool unit: exit code $?"
grep -q 'is up to date$' "$folder/text" ||
  fail "the installed sources are not those of the checkout's unit: $(cat "$folder/text")"
# Every header of the project that a unit and a chip are compiled with is installed; the others are Verilator's.
data=$folder/prefix/share/raypool
for source in "$data"/sim/rtl/rtl_{unit,chip}.cpp; do
  g++ -std=c++17 -MM -MG -I"$data/cpp_model" -I"$data/sim" "$source" > "$folder/text" || fail "$source: no headers"
  missing=$(grep -oE '[^ ]+\.hpp' "$folder/text" | grep -vF "$data/" || true)
  [ -z "$missing" ] || fail "$source needs what is not installed: $missing"
done
"$raypool" sim --scene cornell --size 8x8 --config 4w4c --engine lockstep > "$folder/text"
grep -qE 'lockstep: [1-9][0-9]* cycles.*; 0 differences' "$folder/text" || fail "no lockstep: $(cat "$folder/text")"

# refuses PATTERN COMMAND...: exit code 1 and one line that matches.
refuses() {
  local pattern=$1 code=0; shift
  "$@" 2> "$folder/error" || code=$?
  [ "$code" = 1 ] && [ "$(wc -l < "$folder/error")" = 1 ] && grep -qE -e "$pattern" "$folder/error" ||
    fail "exit code $code, wanted 1 and one line that matches '$pattern': $(cat "$folder/error")"
}
refuses 'space.*XDG_CACHE_HOME' env XDG_CACHE_HOME="$folder/a cache" "$raypool" unit --config 4w4c
refuses 'XDG_CACHE_HOME' env -u HOME -u XDG_CACHE_HOME "$raypool" unit --config 4w4c
touch "$folder/file"
refuses 'cannot write.*XDG_CACHE_HOME' env XDG_CACHE_HOME="$folder/file" "$raypool" unit --config 4w4c

# find_package(raypool): the example, alone and in lockstep.
cmake -S "$folder/prefix/share/raypool/examples/own-chip" -B "$folder/own" -G Ninja \
  -DCMAKE_PREFIX_PATH="$folder/prefix" > "$folder/log" 2>&1 &&
  cmake --build "$folder/own" >> "$folder/log" 2>&1 ||
  { cat "$folder/log" >&2; fail "examples/own-chip does not build"; }
"$folder/own/own_chip" > "$folder/text" || fail "own_chip: exit code $?"
[ "$(grep -cE '256 roots, 0 wrong, [1-9][0-9]* cycles$' "$folder/text")" = 3 ] ||
  fail "own_chip prints: $(cat "$folder/text")"
"$folder/own/own_chip" "$unit" | cmp - "$folder/text" || fail "own_chip with the Verilated unit prints something else"

# The Debian packages: what they need and what they hold; unpacked, the program draws.
cpack --config "$build/CPackConfig.cmake" -B "$folder/packages" > "$folder/log" 2>&1 ||
  { cat "$folder/log" >&2; fail cpack; }
# One version, which CMake's project() has.
version=$(sed -nE 's/^project\(raypool VERSION ([0-9.]+) .*/\1/p' "$root/CMakeLists.txt")
program=$(echo "$folder"/packages/raypool_*.deb) library=$(echo "$folder"/packages/raypool-dev_*.deb)
for package in "$program" "$library"; do
  [ "$(dpkg-deb -f "$package" Version)" = "$version" ] || fail "$package is not of version $version"
done
for needed in libassimp5 libc6 libembree3-3 libfmt9 libsystemc; do
  dpkg-deb -f "$program" Depends | grep -qE "(^|, )$needed( |,|$)" ||
    fail "$program does not depend on $needed: $(dpkg-deb -f "$program" Depends)"
done
[[ $(dpkg-deb -f "$program" Recommends) == *verilator*g++*make* ]] ||
  fail "$program does not recommend what units are built with"
dpkg-deb -x "$program" "$folder/unpacked"
dpkg-deb -x "$library" "$folder/unpacked"
draws "$folder/unpacked/usr/bin/raypool"
diff -r "$folder/unpacked/usr/share/raypool" "$folder/prefix/share/raypool" ||
  fail "the package has other data than cmake --install"
diff -r "$folder/unpacked/usr/include/raypool" "$folder/prefix/include/raypool" ||
  fail "the package has other headers than cmake --install"
grep -qFx "set(PACKAGE_VERSION \"$version\")" \
  "$(find "$folder/unpacked/usr/lib" -name raypool-config-version.cmake)" ||
  fail "find_package(raypool) finds another version than $version"
grep -qr "$root" "$folder/unpacked/usr/lib/cmake" &&
  fail "the package names the checkout: $(grep -r "$root" "$folder/unpacked/usr/lib/cmake")"

files=$(find "$folder/prefix" -type f | wc -l)
echo "installed: $files files; packages: $(basename "$program"), $(basename "$library")"
