#!/bin/bash
# A checkout that was copied or renamed with its build folder builds what it has itself, keeps its results, and never
# writes into the old place: scripts/tests/copied_checkout.sh PROGRAM
# A small project, built by the Makefile and scripts of this one; then PROGRAM, in a copied folder.
set -u -o pipefail
program=$(realpath "$1")
cd "$(dirname "$0")/../.." || exit 1
unset MAKEFLAGS MAKELEVEL MFLAGS RAYPOOL BUILD
folder=$(realpath "$(mktemp -d)")
log=$folder/log
trap 'rm -rf "$folder"' EXIT
fail() {
  echo "FAILED: $*"
  cat "$log"
  exit 1
}

old=$folder/old
mkdir -p "$old"/{cmake,cpp_model,sim,studies,program,tb,scripts}
cp Makefile "$old/"
cp studies/studies.mk "$old/studies/"
cp scripts/*.sh scripts/*.bash "$old/scripts/"
cat > "$old/CMakeLists.txt" << 'END'
cmake_minimum_required(VERSION 3.25)
project(raypool LANGUAGES CXX)
option(RAYPOOL_TESTS "" ON)
option(RAYPOOL_COVERAGE "" OFF)
add_subdirectory(sim)
END
cat > "$old/sim/CMakeLists.txt" << 'END'
add_executable(raypool main.cpp)
target_compile_definitions(raypool PRIVATE WHERE="${CMAKE_SOURCE_DIR}")
set_target_properties(raypool PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR})
END
printf '#include <cstdio>\nint main() { std::puts(WHERE " one"); }\n' > "$old/sim/main.cpp"

built() {
  make -C "$1" program "${@:2}" > "$log" 2>&1 || fail "make program in $1 ends with an error"
}
prints() {
  local text
  text=$("${3:-$1/build}/raypool")
  [ "$text" = "$2" ] || fail "the program of $1 prints '$text', and not '$2'"
}
# Names, times and contents of all files of a folder.
state() { (cd "$1" && find . -type f -printf '%p %T@ ' -exec sha256sum {} \;) | sort; }

built "$old"
prints "$old" "$old one"
(cd / && "$old/scripts/build.sh" "$old/build" raypool) > "$log" 2>&1 || fail "build.sh called from another folder"
mkdir -p "$old/build/out/mine" "$old/build/units/1w1c"
echo picture > "$old/build/out/mine/image.png"
echo library > "$old/build/units/1w1c/libraypool_unit.so"
(cd "$old" && cmake -DRAYPOOL_COVERAGE=ON build > "$log" 2>&1) || fail "an option"
state "$old" > "$folder/before"

for kind in copied renamed; do
  new=$folder/$kind
  if [ "$kind" = copied ]; then
    cp -r "$old" "$new"
  else
    cp -a "$old" "$folder/moved" && mv "$old" "$folder/gone" && mv "$folder/moved" "$new"
  fi
  sed -i 's/ one/ two/' "$new/sim/main.cpp"
  scripts=$new/scripts
  if (cd "$new" && scripts/build.sh build raypool) > "$log" 2>&1 || ! grep -q "was made for $old" "$log"; then
    fail "$scripts/build.sh builds by rules of the old place"
  fi
  built "$new"
  [ "$(grep -c "was made for $old: it is configured and built again for $new" "$log")" = 1 ] ||
    fail "the $kind checkout does not report once that it is configured again"
  prints "$new" "$new two"
  for file in out/mine/image.png units/1w1c/libraypool_unit.so; do
    [ -s "$new/build/$file" ] || fail "the $kind checkout lost $file"
  done
  grep -q '^RAYPOOL_COVERAGE:BOOL=ON' "$new/build/CMakeCache.txt" || fail "the $kind checkout lost an option"
  grep -rIl "$old" "$new/build" > "$log" && fail "files of the $kind checkout name the old one"
  built "$new"
  ! grep -q 'was made for' "$log" || fail "the $kind checkout is configured again a second time"
  echo "ok: a $kind checkout"
done
[ ! -e "$old" ] || fail "something was written into the old place"
state "$folder/gone" | diff "$folder/before" - > "$log" || fail "the old checkout was changed"

# A build folder elsewhere: of two checkouts in turn, and moved.
built "$folder/copied" "BUILD=$folder/elsewhere"
built "$folder/renamed" "BUILD=$folder/elsewhere"
prints "$folder/renamed" "$folder/renamed two" "$folder/elsewhere"
mv "$folder/elsewhere" "$folder/moved"
built "$folder/renamed" "BUILD=$folder/moved"
prints "$folder/renamed" "$folder/renamed two" "$folder/moved"
echo "ok: a build folder elsewhere"

# One of another project is left alone.
sed -i 's/^CMAKE_PROJECT_NAME.*/CMAKE_PROJECT_NAME:STATIC=other/' "$folder/moved/CMakeCache.txt"
state "$folder/moved" > "$folder/before"
if make -C "$folder/copied" program "BUILD=$folder/moved" > "$log" 2>&1 ||
  ! grep -q 'is one of other: choose' "$log"; then
  fail "the build folder of another project is taken"
fi
state "$folder/moved" | grep -v '\./\.lock ' | diff <(grep -v '\./\.lock ' "$folder/before") - > "$log" ||
  fail "the build folder of another project was changed"
echo "ok: a build folder of another project"

# The program itself reads the configurations of the checkout that its build folder is in.
place=${program#"$PWD"/}
if [ "$place" != "$program" ]; then
  mkdir -p "$folder/copy/${place%/*}" "$folder/copy/configs"
  cp "$program" "$folder/copy/$place"
  echo '{"warps": 2}' > "$folder/copy/configs/own.json"
  (cd "$folder" && "copy/$place" config own) > "$log" 2>&1 || fail "a copied program reads the old configurations"
  echo "ok: a copied program"
fi
