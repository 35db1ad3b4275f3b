#!/bin/bash
# examples/*.asm print what their heads show, on every engine: scripts/tests/examples.sh RAYPOOL
# A head holds "#   $ raypool ..." and below it, further in, lines of the output. Needs the
# Verilated unit of 4w4c beside RAYPOOL.
set -eu -o pipefail
raypool=$(realpath "$1")
cd "$(dirname "$0")/../.."
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
runs=0 lines=0
for file in examples/*.asm; do
  command=$(sed -nE 's/^#   \$ raypool (.*)/\1/p' "$file")
  sed -nE 's/^#     ( *[^ ].*)/\1/p' "$file" > "$folder/expected"
  [ -n "$command" ] && [ -s "$folder/expected" ] ||
    { echo "FAILED: the head of $file has no command, or no output" >&2; exit 1; }
  for engine in functional model lockstep; do
    # shellcheck disable=SC2086 # the command's words
    "$raypool" $command --engine "$engine" > "$folder/output" ||
      { echo "FAILED: exit code $? of raypool $command --engine $engine" >&2; exit 1; }
    while IFS= read -r line; do
      grep -qE "^ *$line$" "$folder/output" ||
        { cat "$folder/output"; echo "FAILED: $engine does not print '$line', which $file promises" >&2; exit 1; }
      lines=$((lines + 1))
    done < "$folder/expected"
    runs=$((runs + 1))
  done
done
[ "$runs" -ge 9 ] || { echo "FAILED: only $runs runs" >&2; exit 1; }
echo "$runs runs of examples, $lines lines as their heads have them"
