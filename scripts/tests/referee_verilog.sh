#!/bin/bash
# The Verilog's answers to hard rays are those of the engines with the hardware's hits:
# scripts/tests/referee_verilog.sh RAYPOOL REFEREE_ANSWERS
set -eu -o pipefail
raypool=$(realpath "$1") answers=$(realpath "$2")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cases=9000
"$raypool" referee --cases "$cases" --write "$folder/corpus.jsonl"
"$answers" < "$folder/corpus.jsonl" > "$folder/Verilog.jsonl"
"$raypool" referee --corpus "$folder/corpus.jsonl" --answers "$folder/Verilog.jsonl" --quiet > "$folder/table"
row() { sed -nE "s/^$1 +($cases .*)/\1/p" "$folder/table"; }
[ -n "$(row Verilog)" ] && [ "$(row Verilog)" = "$(row hardware)" ] ||
  { cat "$folder/table"; echo 'FAILED: the rows "hardware" and "Verilog" differ' >&2; exit 1; }
# A case that one of them gets wrong would show: so does an answer that is spoilt.
sed '0,/"hit":true/s//"hit":false/' "$folder/Verilog.jsonl" > "$folder/spoilt.jsonl"
"$raypool" referee --corpus "$folder/corpus.jsonl" --answers "$folder/spoilt.jsonl" --quiet > "$folder/table"
[ "$(row spoilt)" != "$(row hardware)" ] || { echo 'FAILED: a spoilt answer changes no row' >&2; exit 1; }
echo "$cases cases: the rows \"hardware\" and \"Verilog\" are the same"
