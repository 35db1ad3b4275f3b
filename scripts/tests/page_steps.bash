# shellcheck shell=bash
# Sourced by tests of pages whose steps a reader follows: copies the sources and does what a page's marked blocks ask
# for, in their order. A comment before a block marks it:
#   file: PATH                      the block is a new file
#   insert: PATH, after: TEXT       the block goes behind the only line of the file that holds TEXT
#   diff: PATH                      the only place of the file that has the block's lines with '-' or ' ' gets those
#                                   with '+' or ' '
#   run            run, fails       commands that must succeed, or fail
#   expect                          each line of the block is a line of what the last commands printed
# and without a block: replace: PATH, OLD => NEW.
set -eu -o pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
root=$PWD
unset MAKEFLAGS MAKELEVEL MFLAGS BUILD RAYPOOL RAYPOOL_CONFIGS
new=0 inserted=0 ran=0 expected=0 replaced=0

fail() {
  echo "FAILED: $*" >&2
  exit 1
}

# The content of PATH must hold TEXT once; prints the number of its line.
only_line() {
  [ "$(grep -cF -e "$2" "$1")" = 1 ] || fail "$1 holds '$2' not exactly once"
  grep -nF -e "$2" "$1" | cut -d : -f 1
}

# apply_diff PATH DIFF
apply_diff() {
  python3 - "$1" "$2" << 'END'
import pathlib
import sys

path, lines = pathlib.Path(sys.argv[1]), sys.argv[2].splitlines(keepends=True)
old, new = ("".join(line[1:] for line in lines if line[0] in (" ", kept)) for kept in "-+")
text = path.read_text()
if text.count(old) != 1:
    sys.exit(f"FAILED: {path} has {text.count(old)} times:\n{old}")
path.write_text(text.replace(old, new))
END
}

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
    'diff: '*)
      apply_diff "${1#diff: }" "$2"
      replaced=$((replaced + 1))
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
    *) fail "$page: unknown mark '$1'" ;;
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

# copy_sources FOLDER: to FOLDER/tree, where everything below takes place.
copy_sources() {
  mkdir -p "$1"
  folder=$(cd "$1" && pwd)
  output=$folder/output.txt
  rm -rf "$folder/tree"
  mkdir -p "$folder/tree"
  cp -R CMakeLists.txt LICENSE Makefile README.md bench cmake configs cpp_model docs examples program rtl schemas \
    scripts sim studies tb "$folder/tree"
  cd "$folder/tree"
  # Most of the time here is the compiler's, and what it makes runs little.
  replace 'CMakeLists.txt, FLAGS_RELEASE "-O2" => FLAGS_RELEASE "-O0"'
  replaced=0
}

# follow_page PAGE
follow_page() {
  local mark='' inside=no line block
  page=$1
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
      [ -z "$mark" ] || fail "$page: no block follows the mark '$mark'"
      mark=${line#<!-- } mark=${mark% -->}
    fi
  done < "$root/$page"
}

# What was done, for the last line and for a page that has lost blocks.
steps() {
  echo "$new files, $inserted insertions, $ran runs, $expected expected lines, $replaced replacements"
}
