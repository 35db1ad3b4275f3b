#!/bin/bash
# docs/develop/add-an-alu.md works as it stands: scripts/tests/add_an_alu.sh FOLDER
# Copies the sources to FOLDER/tree and does what the page's marked blocks ask for, in their order. A comment before a
# block marks it:
#   file: PATH                      the block is a new file
#   insert: PATH, after: TEXT       the block goes behind the only line of the file that holds TEXT
#   run            run, fails       commands that must succeed, or fail
#   expect                          each line of the block is a line of what the last commands printed
# and without a block: replace: PATH, OLD => NEW. Then looks at what the page does not show: the report, a refused
# configuration, the set of configurations, the tests of random programs, and what Verilator warns of.
set -eu -o pipefail
cd "$(dirname "$0")/../.."
root=$PWD
mkdir -p "$1"
folder=$(cd "$1" && pwd)
tree=$folder/tree output=$folder/output.txt
unset MAKEFLAGS MAKELEVEL MFLAGS BUILD RAYPOOL RAYPOOL_CONFIGS

fail() {
  echo "FAILED: $*" >&2
  exit 1
}

# The content of PATH must hold TEXT once; prints the number of its line.
only_line() {
  [ "$(grep -cF -e "$2" "$1")" = 1 ] || fail "$1 holds '$2' not exactly once"
  grep -nF -e "$2" "$1" | cut -d : -f 1
}

new=0 inserted=0 ran=0 expected=0 replaced=0

# take DIRECTIVE BLOCK
take() {
  local path text line code=0 begin=$SECONDS
  case $1 in
    'file: '*)
      path=${1#file: }
      [ ! -e "$path" ] || fail "$path is no new file"
      printf '%s' "$2" > "$path"
      new=$((new + 1))
      ;;
    'insert: '*', after: '*)
      path=${1#insert: } path=${path%%, after: *} text=${1#*, after: }
      line=$(only_line "$path" "$text")
      printf '%s' "$2" > "$folder/block.txt"
      sed -i "${line}r $folder/block.txt" "$path"
      inserted=$((inserted + 1))
      ;;
    run | 'run, fails')
      bash -eu -o pipefail -c "$2" > "$output" 2>&1 || code=$?
      echo "in $((SECONDS - begin)) s: $2"
      if [ "$1" = run ] && [ "$code" != 0 ]; then cat "$output"; fail "exit code $code of: $2"; fi
      if [ "$1" != run ] && [ "$code" = 0 ]; then cat "$output"; fail "this should have failed: $2"; fi
      ran=$((ran + 1))
      ;;
    expect)
      while IFS= read -r line; do
        grep -qFx -e "$line" "$output" ||
          { cat "$output"; fail "the page shows a line that is not in the output above: $line"; }
        expected=$((expected + 1))
      done < <(printf '%s' "$2")
      ;;
    *) fail "docs/develop/add-an-alu.md: unknown mark '$1'" ;;
  esac
}

# replace PATH, OLD => NEW
replace() {
  local path=${1%%, *} change=${1#*, } content
  content=$(< "$path")
  only_line "$path" "${change%% => *}" > "$folder/line.txt"
  printf '%s\n' "${content/"${change%% => *}"/"${change#* => }"}" > "$path"
  replaced=$((replaced + 1))
}

rm -rf "$tree"
mkdir -p "$tree"
cp -R CMakeLists.txt Makefile bench cmake configs cpp_model docs examples LICENSE program rtl schemas scripts sim \
  studies tb "$tree"
cd "$tree"
# Most of the time here is the compiler's, and what it makes runs little.
replace 'CMakeLists.txt, FLAGS_RELEASE "-O2" => FLAGS_RELEASE "-O0"'
replaced=0

mark='' inside=no
while IFS= read -r line; do
  if [ "$inside" = yes ] && [ "$line" = '```' ]; then
    inside=no
    [ -z "$mark" ] || take "$mark" "$block"
    mark=''
  elif [ "$inside" = yes ]; then
    block+=$line$'\n'
  elif [[ $line == '```'* ]]; then
    inside=yes block=''
  elif [[ $line == '<!-- replace: '*' -->' ]]; then
    line=${line#<!-- replace: }
    replace "${line% -->}"
  elif [[ $line == '<!-- '*' -->' ]]; then
    [ -z "$mark" ] || fail "docs/develop/add-an-alu.md: no block follows the mark '$mark'"
    mark=${line#<!-- } mark=${mark% -->}
  fi
done < "$root/docs/develop/add-an-alu.md"
[ $new -ge 3 ] && [ $inserted -ge 2 ] && [ $ran -ge 4 ] && [ $expected -ge 10 ] && [ $replaced -ge 1 ] ||
  fail "the page lost blocks: $new files, $inserted insertions, $ran runs," \
    "$expected expected lines, $replaced replacements"

take run 'build/raypool sim --scene cornell --size 8x8 --depth 1 --config boxes.json --engine model --out out --quiet'
grep -q '"box": *{' out/report.json || fail "out/report.json does not name the ALU box"
take 'run, fails' "echo '{\"alus\": {\"box\": {\"depth\": 1}}}' > shallow.json; build/raypool config shallow.json"
grep -q 'alus.box.depth is 1; it must be an integer from 2 to 32' "$output" ||
  { cat "$output"; fail "a depth of 1 is not refused"; }
take run 'build/raypool configurations'
grep -q '; tid brh int flt slw box as count/latency/depth, ' "$output" ||
  { cat "$output"; fail "the set of configurations has no column for box"; }
lint='verilator --lint-only -Wall --default-language 1364-2005'
take run "$lint -Irtl/include rtl/waivers.vlt --top-module rp_multiprocessor rtl/*/*.v"
[ ! -s "$output" ] || { cat "$output"; fail "Verilator warns of the page's module"; }
take run 'scripts/configure.sh build ON -DRAYPOOL_UNIT_BENCHES=OFF; cmake --build build --target raypool_cosim_test'
take run "build/sim/raypool_cosim_test --gtest_filter='RandomPrograms.*:Covering*'"
echo "$new files, $inserted insertions, $ran runs, $expected expected lines, $replaced replacement as the page has them"
