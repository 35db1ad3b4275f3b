#!/bin/bash
# The catalogue of extremes and the referee's corpus on a small chip, all of it in Verilog, in lockstep with its model:
# studies/tests/on_chip.sh RAYPOOL [CASES]
set -eu -o pipefail
raypool=$(realpath "$1") cases=${2:-1500}
root=$(dirname "$0")/../..
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
export RAYPOOL=$raypool
failed() { cat "$folder/table"; echo "FAILED: $*" >&2; exit 1; }

"$root/scripts/unit.sh" tiny
for traverser in hardware static; do
  "$root/scripts/unit.sh" tiny --boundary chip --set "chip.traverser=$traverser"
done
"$raypool" numerics --extremes --boundary chip --config tiny --mode ieee-exact --quiet > "$folder/table" ||
  failed 'an extreme is not what is expected of it'
grep -qE '^  .* nfmlc$' "$folder/table" || failed 'no extreme was drawn on the chip'
tail -1 "$folder/table"

"$raypool" referee --cases "$cases" --on-chip lockstep --quiet > "$folder/table"
row() { sed -nE "s/^$1 +($cases .*)/\1/p" "$folder/table"; }
[ -n "$(row 'chip, lockstep')" ] && [ "$(row 'chip, lockstep')" = "$(row hardware)" ] ||
  failed 'the rows "hardware" and "chip, lockstep" differ'
echo "$cases cases: the rows \"hardware\" and \"chip, lockstep\" are the same"
