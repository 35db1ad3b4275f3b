#!/bin/bash
# Proves the control logic: tb/proofs/control.sh [--quick | --broken] [NAME...]. NAME is a checker
# tb/proofs/control/NAME.v; without one, all of them.
# A checker is a module `check` around what it checks, with assumptions and assertions; its head has
#   @modules FILE...           of rtl/, without prefix and .v
#   @proves SENTENCE           printed when it holds, once for each
#   @parameters NAME=VALUE...  set of parameters to prove it for; more lines are more
#                              proofs; without one, as the checker stands
#   @break FILE SED            a sed script that breaks FILE (NAME.vh: a header); the proof must then fail
#   @zeros                     registers that have no reset start as 0 instead of anything
#   @slow                      not with --quick
#   @long SECONDS              so long with --quick; `make test` leaves it to the long tests
# A sentence or a script goes on in lines that begin with `//   `.
# Every proof is unbounded (property-directed reachability, ABC's pdr); counterexamples for broken copies are found by
# bmc3, within 40 cycles. --quick leaves the broken copies out, --broken tries only these.
# Exit code 1 if a proof fails, or holds for a broken copy.
set -eu -o pipefail
cd "$(dirname "$0")/../.."
quick='' only_broken=''
case ${1:-} in
  --quick) quick=1; shift ;;
  --broken) only_broken=1; shift ;;
esac
for tool in yosys yosys-abc; do
  command -v $tool > /dev/null ||
    { echo "control.sh: $tool was not found: install it (Debian package yosys)" >&2; exit 1; }
done
names=("$@")
[ ${#names[@]} -gt 0 ] || for file in tb/proofs/control/*.v; do names+=("$(basename "$file" .v)"); done
TIMEFORMAT=%U   # processor time: other work on the machine does not count
folder=$(mktemp -d)
exec 3>&1
trap 'rm -rf "$folder"' EXIT

# of_head KEY CHECKER: what the checker's head has with @KEY, one a line.
of_head() {
  awk -v key="// @$1 " '
    function flush() { if (line != "") print line; line = "" }
    index($0, key) == 1 { flush(); line = substr($0, length(key) + 1); next }
    line != "" && /^\/\/   / { sub(/^\/\/ +/, ""); line = line " " $0; next }
    { flush() }' "$2"
}

# solve CHECKER PARAMETERS FILE...: runs ABC's commands in engine; sets verdict to proved, refuted or unknown, and depth
# to the length of the counterexample.
solve() {
  local checker=$1 parameters=$2 parameter chparam='' zeros=''
  shift 2
  for parameter in $parameters; do chparam+=" -set ${parameter%=*} ${parameter#*=}"; done
  [ -z "$chparam" ] || chparam="chparam$chparam check;"
  ! grep -q '^// @zeros' "$checker" || zeros="zinit -all;"
  yosys -q -l "$folder/yosys" -p "read_verilog -formal -DSYNTHESIS -I$folder -Irtl/include $checker $*
    $chparam prep -top check -flatten; delete -output; memory_map; async2sync; $zeros opt -fast
    setundef -undriven -anyseq; setundef -anyseq; formalff -clk2ff -ff2anyinit; techmap; opt -fast; dffunmap; aigmap
    opt_clean; setundef -undriven -anyseq; setundef -anyseq
    write_aiger -I -B -zinit -no-startoffset $folder/check.aig" > "$folder/console" 2>&1 ||
    { echo "FAILED: $checker: yosys reports"; tail -3 "$folder/console"; exit 1; } >&3
  yosys-abc -c "read_aiger $folder/check.aig; fold; strash; $engine; print_status" > "$folder/abc" 2>&1 || true
  verdict=unknown depth=
  if grep -q '^Status = 1' "$folder/abc"; then verdict=proved
  elif grep -q '^Status = 0' "$folder/abc"; then
    verdict=refuted
    depth=$(sed -nE 's/.*asserted in frame ([0-9]+).*/\1/p' "$folder/abc" | tail -1)
  fi
}

failed=0
for name in "${names[@]}"; do
  checker=tb/proofs/control/$name.v
  [ -f "$checker" ] || { echo "control.sh: there is no checker '$name'; see tb/proofs/control" >&2; exit 1; }
  [ -z "$quick" ] || ! grep -q '^// @slow' "$checker" || continue
  files=
  for module in $(of_head modules "$checker"); do files+=" $(printf %s rtl/*/"rp_$module.v")"; done
  mapfile -t sets < <(of_head parameters "$checker")
  [ ${#sets[@]} -gt 0 ] || sets=("")
  for set in "${sets[@]}"; do
    [ -z "$only_broken" ] || break
    engine="scorr; pdr -T 600"
    # shellcheck disable=SC2086 # a list of files
    { time solve "$checker" "$set" $files; } 2> "$folder/time"
    if [ $verdict = proved ]; then echo "proved: $name${set:+, $set} (pdr, $(tail -1 "$folder/time") s)"
    else
      failed=1
      echo "FAILED: $name${set:+, $set}: $verdict${depth:+ after $depth cycles}"
      tail -3 "$folder/abc"
    fi
  done
  [ -n "$only_broken" ] && echo "$name" || of_head proves "$checker" | sed 's/^/  - /'
  [ -z "$quick" ] || continue
  broken=0
  while read -r module script; do
    engine="bmc3 -F 40 -T 300"
    [[ $module = *.* ]] || module=$module.v
    file=$(printf %s rtl/*/"rp_$module") broken_file=$folder/rp_$module
    sed -E "$script" "$file" > "$broken_file"
    ! cmp -s "$file" "$broken_file" ||
      { echo "FAILED: $name: '$script' changes nothing in $file"; failed=1; continue; }
    # shellcheck disable=SC2086 # a list of files
    solve "$checker" "${sets[0]}" ${files/$file/$broken_file}
    rm "$broken_file"
    if [ $verdict = refuted ]; then
      broken=$((broken + 1))
      [ -z "${VERBOSE:-}" ] || echo "  broken: $module $script: refuted after $depth cycles"
    else
      failed=1
      echo "FAILED: $name: $verdict with $file broken by '$script'"
    fi
  done < <(of_head break "$checker")
  [ $broken -gt 0 ] || { echo "FAILED: $name: no broken copy was refuted"; failed=1; }
  echo "  broken copies refuted: $broken"
done
exit $failed
