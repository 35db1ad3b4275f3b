#!/bin/bash
# Builds machines that carry every mistake of tb/faults/catalogue.json: scripts/faults.sh FOLDER [MACHINE]...
# The environment variable RAYPOOL_FAULT selects the mistake (none: 0) of every unit made after it is set. The machines
# are the small one of the cosim tests, as one unit and as four, one with all features of `best`, those that the tests
# configurations_quick_* walk, and the others of `raypool cosim` by the names of their files. FOLDER gets
#   rtl/                      the Verilog with the mistakes
#   NAME/libraypool_unit.so   a machine
#   list                      a line for each: name, file of the configuration, units
# MACHINE: only these, by name. RAYPOOL names the raypool program (default build/raypool).
# What is up to date is not built again.
set -eu -o pipefail
[ $# -ge 1 ] || { echo "usage: scripts/faults.sh FOLDER [MACHINE]..." >&2; exit 1; }
root=$(cd "$(dirname "$0")/.." && pwd)
mkdir -p "$1"
folder=$(cd "$1" && pwd)
shift
build=${BUILD:-build}
[[ $build == /* ]] || build=$root/$build
raypool=$(realpath "${RAYPOOL:-$build/raypool}")
cd "$root"

# verilate.sh builds from the tree that it stands in: one of links, but for rtl/.
for link in cpp_model sim scripts; do ln -sfn "$root/$link" "$folder/$link"; done
python3 scripts/faults.py tb/faults/catalogue.json rtl "$folder/rtl"

"$raypool" configurations --most 12 --out "$folder/configurations" > /dev/null
small=$root/tb/mutants/2w2c.json
machines=("2w2c $small 1" "2w8c-best ${small%2w2c.json}2w8c_best.json 1" "2w2c-4cu $small 4")
while read -r file units; do
  machines+=("${file%.json} $folder/configurations/$file $units")
done < "$folder/configurations/list"
while read -r file units; do
  [ "$file" -ef "$small" ] || machines+=("$(basename "$file" .json) $file $units")
done < <("$raypool" cosim --machines)

rm -f "$folder/list"
for machine in "${machines[@]}"; do
  read -r name file units <<< "$machine"
  [ $# = 0 ] || [[ " $* " == *" $name "* ]] || continue
  # shellcheck disable=SC2046 # each parameter is a word
  JOBS=${JOBS:-$(nproc)} "$folder/scripts/verilate.sh" "$folder/$name" --quick "UNITS=$units" \
    $("$raypool" config "$file" --verilog-parameters) |
    { grep -v 'is up to date$' || true; }
  echo "$machine" >> "$folder/list"
done
[ -f "$folder/list" ] || { echo "faults.sh: there is no machine $*" >&2; exit 1; }
