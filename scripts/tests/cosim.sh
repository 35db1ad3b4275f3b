#!/bin/bash
# `raypool cosim` on its set of machines and on one: scripts/tests/cosim.sh RAYPOOL FOLDER. The units of the set are
# built (scripts/cosim_units.sh).
set -u -o pipefail
raypool=$(realpath "$1") folder=$2
cd "$(dirname "$0")/../.." || exit 1
mkdir -p "$folder"
# shellcheck source=scripts/tests/expect.bash
. scripts/tests/expect.bash
cosim=("$raypool" cosim --quiet --no-minimise)

mapfile -t machines < <("$raypool" cosim --machines)
expect "machines share the programs, and one table has them all" 0 "cosim on ${#machines[@]} machines: 9 programs" \
  "${cosim[@]}" --programs 9 --coverage "$folder/set.json"
# The first has a program more than the last: 9 are shared.
expect "their counts are one file" 0 "3 2 2 2 of 9" python3 -c '
import json, sys
machines = json.load(open(sys.argv[1]))["machines"]
print(*(machine["programs"] for machine in machines), "of", sum(machine["programs"] for machine in machines))
' "$folder/set.json"
expect "the set lacks no feature, and lists the values that no machine has" 0 "no machine has (make configurations" \
  "${cosim[@]}" --programs 4
"${cosim[@]}" --programs 4 > "$folder/set.txt"
expect "each machine has its column" 0 "4 x 2w1c_units" grep "^coverage" "$folder/set.txt"
expect "no feature is reported as missing" 1 "" grep "not tried" "$folder/set.txt"
expect "fewer programs than machines leave features out, which is reported" 0 \
  "not tried, as no machine has them: several units" "${cosim[@]}" --programs 2
expect "what one machine lacks is listed" 0 "not tried, as 2w2c_small lacks them: several units, triples" \
  "${cosim[@]}" --config configs/cosim/2w2c_small.json --programs 2
read -r file units <<< "${machines[2]}"
expect "several units of one machine lack less" 0 "not tried, as 4 x 2w1c_units lacks them: several lanes, triples" \
  "${cosim[@]}" --config "$file" --units "$units" --programs 2
expect "no programs at all are refused" 1 "give each at least one" "${cosim[@]}" --programs 0
expect "a unit without its machine is refused" 1 "name it with --config" "${cosim[@]}" --unit-library "$folder/none.so"
expect "fields without their machine are refused" 1 "--set requires --config" "${cosim[@]}" --set warps=2
unset CONFIG CUS SET MAKEFLAGS MAKELEVEL
expect "the makefile's call is the set's" 0 "cosim \${PROGRAMS:+\"--programs=\$PROGRAMS\"}" make -n cosim
expect "with CONFIG it is one machine" 0 "cosim \${CONFIG:+\"--config=\$CONFIG\"}" make -n cosim CONFIG=4w4c
expect "so it is with CUS" 0 "\${CUS:+\"--units=\$CUS\"}" make -n cosim CUS=2
expect "so it is with CONFIG of the environment" 0 "cosim \${CONFIG" env CONFIG=4w4c make -n cosim
expect "but not with what an outer make exports" 0 "scripts/cosim_units.sh" env MAKELEVEL=1 CONFIG=8w8c make -n cosim

[ "$failures" = 0 ] || { echo "$failures cases failed"; exit 1; }
