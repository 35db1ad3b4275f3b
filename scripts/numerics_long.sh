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
for bench in flt_alu_test flt_alu_large_test slw_alu_test slw_alu_large_test brh_alu_test small_floats_test; do
  part "$build/tb/$bench" --gtest_brief=1 --gtest_filter='*Long*'
done
echo
grep -m 1 '^operation' "$log"
# What and four numbers.
rows() { grep -E '^[^ ].* +[0-9]+ +[0-9]+ +[0-9]+ +[0-9]+$' "$log"; }
rows | grep -v ' bits  ' || true
echo
# Of the shorter significands a row an operation: what was tried in the mode in which it was less.
rows | sed -n 's/, \([0-9]*\) bits  / \1 /p' | awk '
  BEGIN { split("20 16 13 11", widths); heading = sprintf("%-37s", "operation, inputs in each mode")
    for (i = 1; i <= 4; ++i) heading = heading sprintf(" %9s", widths[i] " bits")
    print heading "  errors" }
  { width = $(NF - 4); what = $1; for (i = 2; i < NF - 4; ++i) what = what " " $i
    if (!(what in errors)) order[++operations] = what
    tried[what, width] = $(NF - 3) < $(NF - 1) ? $(NF - 3) : $(NF - 1); errors[what] += $(NF - 2) + $NF }
  END { for (o = 1; o <= operations; ++o) { what = order[o]; line = sprintf("%-37s", what)
      for (i = 1; i <= 4; ++i) line = line sprintf(" %9d", tried[what, widths[i]])
      print line sprintf(" %7d", errors[what]) } }'
echo "numerics-long: $((SECONDS / 60)) minutes, failed: ${failed[*]:-none}"
[ ${#failed[@]} -eq 0 ]
