#!/bin/bash
# Runs every long comparison of arithmetic and ends with one table of all inputs tried and errors found:
# scripts/numerics_long.sh BUILD THREADS.
# Only numerics_long has threads. Exit code 1 if anything is wrong.
set -eu -o pipefail
build=$1 threads=$2
log=$build/numerics-long.txt
: > "$log"
failed=()
part() {
  local begin=$SECONDS
  "$@" 2>&1 | tee -a "$log" || failed+=("$(basename "$1")")
  echo "$(basename "$1"): $((SECONDS - begin)) s" | tee -a "$log"
}
part "$build/tb/numerics_long" 100000000 1 "$threads"
for bench in flt_alu_test slw_alu_test small_floats_test; do
  part "$build/tb/$bench" --gtest_brief=1 --gtest_filter='*Long*'
done
echo
grep -m 1 '^operation' "$log"
# What and four numbers.
grep -E '^[^ ].* +[0-9]+ +[0-9]+ +[0-9]+ +[0-9]+$' "$log"
echo "numerics-long: $((SECONDS / 60)) minutes, failed: ${failed[*]:-none}"
[ ${#failed[@]} -eq 0 ]
