#!/bin/bash
# The program describes itself truly: version, exit codes, man page, completion, --json:
# scripts/tests/self_description.sh RAYPOOL
set -eu -o pipefail
raypool=$(realpath "$1")
cd "$(dirname "$0")/../.."
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
fail() {
  echo "FAILED: $*" >&2
  exit 1
}

# One version: that of CMakeLists.txt.
version=$(sed -nE 's/^project\(raypool VERSION ([0-9.]+) .*/\1/p' CMakeLists.txt)
[ -n "$version" ] || fail "CMakeLists.txt has no project(raypool VERSION ...)"
"$raypool" --version > "$folder/version"
grep -qE "^raypool ${version//./\\.}( \(.+\))?$" "$folder/version" ||
  fail "raypool --version does not begin with $version: $(cat "$folder/version")"
grep -qE '^SystemC [0-9.]+.*Embree [0-9.]+' "$folder/version" ||
  fail "raypool --version names no libraries: $(cat "$folder/version")"

# The table of docs/use/package.md is that of --help.
"$raypool" --help | sed -nE 's/^  ([0-9])  (.*)/| \1 | \2 |/p' > "$folder/codes"
[ "$(wc -l < "$folder/codes")" -ge 4 ] || fail "raypool --help lists no exit codes"
sed -nE '/^\| [0-9] \|/p' docs/use/package.md | diff "$folder/codes" - ||
  fail "docs/use/package.md has other exit codes than raypool --help"

# What --help knows, the man page and every completion know.
"$raypool" man > "$folder/man"
grep -qF "\"raypool $version\"" "$folder/man" || fail "the man page has another version than $version"
for shell in bash zsh fish; do "$raypool" completion "$shell" > "$folder/$shell"; done
sed -E 's/\\f[BIR]//g; s/\\-/-/g' "$folder/man" > "$folder/text"
groups='Simulate Verify Look_at_and_convert Machine_and_synthesis Studies Shell'
[ "$("$raypool" --help | grep -E '^[A-Z][a-z ]+:$' | tr -d : | tr ' ' _ | paste -sd ' ')" = \
  "$groups Options Exit_codes" ] || fail "raypool --help has other groups: $("$raypool" --help)"
"$raypool" --help | sed -nE '/^(Simulate|Verify|Look .*|Machine .*|Studies|Shell):$/,/^$/s/^  ([a-z]+) .*/\1/p' \
  > "$folder/commands"
[ "$(wc -l < "$folder/commands")" -ge 15 ] || fail "raypool --help lists only $(wc -l < "$folder/commands") commands"
[ "$(sed -nE 's/^\.SH //p' "$folder/man" | tr ' ' _ | paste -sd ' ')" = \
  "NAME SYNOPSIS OPTIONS ${groups^^} EXIT_STATUS ENVIRONMENT" ] ||
  fail "the man page has other groups than raypool --help"
[ "$(sed -nE 's/^\.SS //p' "$folder/man")" = "$(cat "$folder/commands")" ] ||
  fail "the man page has the commands in another order than raypool --help"
options=0
while read -r command; do
  grep -qFx ".SS $command" "$folder/man" || fail "the man page lacks $command"
  awk -v command=".SS $command" '/^\.S[SH]/ { inside = $0 == command } inside' "$folder/text" > "$folder/section"
  "$raypool" "$command" --help > "$folder/help"
  grep -E '^.{101}' "$folder/help" && fail "raypool $command --help has lines of more than 100 columns"
  grep -oE '^  \[?(-[a-z],)?--[a-z-]+' "$folder/help" | grep -oE -- '--[a-z-]+' > "$folder/options"
  while read -r option; do
    grep -qE -e "(^|, )$option\b" "$folder/section" || fail "the man page lacks $command $option"
    grep -qE -e "^    $command\) words='(.* )?${option}[ ']" "$folder/bash" ||
      fail "bash completion lacks $command $option"
    awk -v command="$command)" '$1 ~ /^[a-z]+\)$/ { inside = $1 == command } inside' "$folder/zsh" |
      grep -qE -e "'\*?$option\[" ||
      fail "zsh completion lacks $command $option"
    grep -qE -e "__fish_seen_subcommand_from $command'.* -l ${option#--}( |$)" "$folder/fish" ||
      fail "fish completion lacks $command $option"
    options=$((options + 1))
  done < "$folder/options"
done < "$folder/commands"
"$raypool" sim --help | grep -E '^[A-Z][a-z ]+:$' | tr -d : | paste -sd ',' > "$folder/groups"
[ "$(cat "$folder/groups")" = 'Scene and view,Machine,Engine,Sampling,Output,Options' ] ||
  fail "raypool sim --help has other groups: $(cat "$folder/groups")"
"$raypool" --help-all > "$folder/all"
while read -r command; do
  grep -qE "^Usage: raypool $command( |$)" "$folder/all" || fail "raypool --help-all lacks $command"
done < "$folder/commands"
[ "$options" -ge 80 ] || fail "only $options options were found in --help"

# What a press of the tabulator brings.
completes() {
  local wanted=$1; shift
  local got
  got=$(bash -c '. "$1"; shift; COMP_WORDS=(raypool "$@"); COMP_CWORD=$#; _raypool; echo "${COMPREPLY[*]}"' \
    bash "$folder/bash" "$@")
  [ "$got" = "$wanted" ] || fail "bash completes 'raypool $*' with '$got', not '$wanted'"
}
completes 'sim' sim
completes '--engine' sim --eng
completes 'rtl' sim --engine rt
completes 'fish' completion 'fi'
if command -v groff > /dev/null; then
  [ -z "$(groff -man -ww -z "$folder/man" 2>&1)" ] ||
    fail "groff complains about the man page: $(groff -man -ww -z "$folder/man" 2>&1)"
fi
if command -v zsh > /dev/null; then zsh -n "$folder/zsh"; fi
if command -v fish > /dev/null; then fish -n "$folder/fish"; fi

# The report and nothing else.
"$raypool" sim --scene cornell --size 8x8 --depth 1 --engine model --out "$folder/out" --json > "$folder/json" \
  2> "$folder/errors"
cmp "$folder/json" "$folder/out/report.json" || fail "--json is not report.json"
[ ! -s "$folder/errors" ] || fail "--json leaves on standard error: $(cat "$folder/errors")"

echo "$options options of $(wc -l < "$folder/commands") commands are in the man page and three completions"
