#!/bin/bash
# Walks a set of configurations, each with random programs in lockstep: scripts/configurations.sh small|pairs PROGRAMS [FOLDER]
# small: few that compile quickly and cover every value. pairs: every pair of values, which takes hours. FOLDER (default build/configurations) gets
# their JSON files. Goes on after a failure, prints a line for each configuration, and ends with 1 if one failed. RAYPOOL names the program.
set -eu -o pipefail
[ $# -ge 2 ] || { echo "usage: scripts/configurations.sh small|pairs PROGRAMS [FOLDER]" >&2; exit 1; }
cd "$(dirname "$0")/.."
set=$1 programs=$2 folder=${3:-build/configurations}
export RAYPOOL=${RAYPOOL:-build/raypool}
flags=()
case $set in
  small) ;;
  pairs) flags=(--all-pairs) ;;
  *) echo "configurations.sh: the set is small or pairs, not '$set'" >&2; exit 1 ;;
esac
rm -rf "${folder:?}/$set"
"$RAYPOOL" configurations "${flags[@]}" --out "$folder/$set"
log=$(mktemp)
trap 'rm -f "$log"' EXIT
failed=() count=0
for file in "$folder/$set"/*.json; do
  name=$(basename "$file" .json) begin=$SECONDS
  count=$((count + 1))
  if ! scripts/unit.sh "$file" > "$log" 2>&1; then
    failed+=("$name")
    cat "$log"
    echo "$name: does not build; again with: scripts/unit.sh $file"
    continue
  fi
  built=$((SECONDS - begin)) begin=$SECONDS
  if "$RAYPOOL" cosim --config "$file" --programs "$programs" --quiet > "$log" 2>&1; then
    echo "$name: $programs programs, $(grep -oE '[0-9]+ instructions' "$log" | head -n 1), $(grep -oE '[0-9]+ differences' "$log"); built in $built s, ran $((SECONDS - begin)) s"
  else
    failed+=("$name")
    cat "$log"
    echo "$name: FAILED; again with: $RAYPOOL cosim --config $file --programs $programs"
  fi
done
echo "$count configurations walked, ${#failed[@]} failed ${failed[*]:-}"
[ ${#failed[@]} = 0 ]
