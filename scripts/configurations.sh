#!/bin/bash
# Walks a set of machines, each with random programs in lockstep:
# scripts/configurations.sh quick|small|all PROGRAMS [FOLDER [K/N]]
# quick: every value and most pairs. small: every pair of values that a machine of 8 threads can have. all: every pair,
# large machines included, which takes hours.
# FOLDER (default build/configurations) gets the configurations and the Verilated units. K/N: only every N-th machine,
# from the K-th. Goes on after a failure,
# prints a line for each machine, and ends with 1 if one failed. RAYPOOL names the program.
set -eu -o pipefail
usage="usage: scripts/configurations.sh quick|small|all PROGRAMS [FOLDER [K/N]]"
[ $# -ge 2 ] && [[ ${4:-1/1} =~ ^[1-9][0-9]*/[1-9][0-9]*$ ]] || { echo "$usage" >&2; exit 1; }
cd "$(dirname "$0")/.."
set=$1 programs=$2 folder=${3:-${BUILD:-build}/configurations} part=${4:-1/1}
export RAYPOOL=${RAYPOOL:-${BUILD:-build}/raypool}
flags=() quick=--quick
case $set in
  quick) flags=(--most 12) ;;
  small) ;;
  all) flags=(--all-pairs) quick= ;;
  *) echo "configurations.sh: the set is quick, small or all, not '$set'" >&2; exit 1 ;;
esac
"$RAYPOOL" configurations "${flags[@]}" --out "$folder/$set" | tail -n 1
log=$(mktemp)
trap 'rm -f "$log"' EXIT
failed=() count=0
while read -r file units <&3; do
  name=${file%.json} begin=$SECONDS
  file=$folder/$set/$file unit=$folder/$set/$name
  run=("$RAYPOOL" cosim --config "$file" --units "$units" --unit-library "$unit/libraypool_unit.so" \
    --programs "$programs" --quiet)
  count=$((count + 1))
  # shellcheck disable=SC2206,SC2207 # each parameter is a word, and quick is an option or nothing
  build=(scripts/verilate.sh "$unit" $quick "UNITS=$units" $("$RAYPOOL" config "$file" --verilog-parameters))
  if ! JOBS=$(nproc) "${build[@]}" > "$log" 2>&1; then
    failed+=("$name")
    cat "$log"
    echo "$name: does not build; again with: ${build[*]}"
    continue
  fi
  built=$((SECONDS - begin)) begin=$SECONDS
  if "${run[@]}" > "$log" 2>&1; then
    compared="$(grep -oE '[0-9]+ instructions' "$log" | head -n 1), $(grep -oE '[0-9]+ differences' "$log")"
    echo "$name, $units units: $programs programs, $compared; built in $built s, ran $((SECONDS - begin)) s"
  else
    failed+=("$name")
    cat "$log"
    echo "$name: FAILED; again with: ${run[*]}"
  fi
done 3< <(awk -v first="${part%/*}" -v every="${part#*/}" 'NR % every == first % every' "$folder/$set/list")
echo "$count machines walked, ${#failed[@]} failed ${failed[*]:-}"
[ "$count" -gt 0 ] && [ ${#failed[@]} = 0 ]
