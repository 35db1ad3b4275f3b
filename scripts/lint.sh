#!/bin/bash
# Checks the sources: scripts/lint.sh [KIND]... (default: all kinds)
#   verilog  Verilator and Icarus for several configurations, Yosys for those that are small
#   pages    the table of modules, what the pages name, the layers of the folders, licences
#   columns  no line is longer than 120 columns
#   python   flake8 (.flake8)
#   shell    shellcheck (.shellcheckrc)
#   cpp      clang-format, and clang-tidy on what has changed since the last commit that passed (scripts/passed.sh; the
#            tests tidy_* of make test-long read all); needs the build folder (BUILD, default build) configured with
#            tests
# Not among all kinds, since they take minutes; tests of the same names, of make test-long, do them:
#   lint_units, lint_chip, lint_blocks   Yosys for the large multiprocessors, for whole chips and traversers, and for
#                                        large blocks of these
# Prints what failed and the command that shows it again; ends with 1 if anything did. Keeps in the build folder how
# long all kinds took.
set -u -o pipefail
cd "$(dirname "$0")/.." || exit 1
export LC_ALL=C.UTF-8 build=${BUILD:-build}
. scripts/duration.bash
kinds=(verilog pages columns python shell cpp)
long_kinds=(lint_units lint_chip lint_blocks)
for kind in "$@"; do
  [[ " ${kinds[*]} ${long_kinds[*]} " == *" $kind "* ]] ||
    { echo "lint: '$kind' is not a kind of check; there are ${kinds[*]}, and without one all of these are done;" \
      "and ${long_kinds[*]}" >&2; exit 1; }
done
chosen=("${@:-${kinds[@]}}")
checks=0
scratch=$(mktemp -d)
failed=$scratch/failed
touch "$failed"
trap 'rm -rf "$scratch"' EXIT

# check NAME COMMAND...: silent success; on failure, or on any output when the tool only warns, prints it and how to
# repeat it. As many run at a time as there are cores.
check() {
  checks=$((checks + 1))
  while [ "$(jobs -rp | wc -l)" -ge "$(nproc)" ]; do wait -n; done
  run_check "$scratch/$checks" "$@" &
}

run_check() {
  local log=$1 name=$2 begin=$SECONDS; shift 2
  if "$@" > "$log" 2>&1 && ! grep -qiE 'warning|error' "$log"; then
    echo "lint: $name: clean ($((SECONDS - begin)) s)"
  else
    echo "$name" >> "$failed"
    # In one piece, so that no other's line comes between.
    printf '%s\nlint: %s: NOT clean; again with:\n%s\n' "$(cat "$log")" "$name" "$(printf ' %q' "$@")"
  fi
}

# Corners of the parameter space: the smallest, the largest, narrow and wide warps, every
# optional mode, every number of units.
small_configurations=(
  "multiprocessor WARPS=4 LANES=4 SLOW_UNIT=3 BRH_LATENCY=2 SIGNIFICAND=13"
)
unit_configurations=(
  "WARPS=8 LANES=8"
  "UNITS=2 WARPS=4 LANES=2 INTERSECTION_WORDS=12 SUBNORMALS=2"
  "UNITS=4 WARPS=1 LANES=1 STACK_DEPTH=2 DATA_CACHE_MSHRS=1 INSTRUCTION_CACHE_BYTES=512 DATA_CACHE_BYTES=512"
  "WARPS=32 LANES=1"
  "WARPS=1 LANES=32"
  "WARPS=2 LANES=16 INT_COUNT=2 FLT_COUNT=4 SLW_LATENCY=3 TID_DEPTH=2 SUBNORMALS=1 SLOW_UNIT=2 WIDE_RAY_MEMORY=1"
  "WARPS=2 LANES=2 FMA=1 FLT_DEPTH=5 SIGNIFICAND=16 TRIPLES=1 KERNEL_OVERLAP=1 SLOW_LANES=1 SUBNORMALS=2"
)

# The chip's modules, which the multiprocessor does not hold: top, and parameters.
small_configurations+=(
  "ray_pool SIZE=512"
  "ray_pool SIZE=1 OVERHEAD=1"
  "ray_pool SIZE=5 OVERHEAD=9 CYCLES_PER_BEAT=3 PIPELINED=1 CULLING=1"
  "intersection_pool SIZE=512"
  "intersection_pool SIZE=1 OVERHEAD=1 INTERSECTION_WORDS=12 PIPELINED=1"
  "intersection_pool SIZE=5 OVERHEAD=9 CYCLES_PER_BEAT=64 INTERSECTION_WORDS=16 CULLING=1"
  "thesis_policy CONTENTS=1 RAY_POOL_SIZE=1 INTERSECTION_POOL_SIZE=1"
  "fill_policy CONTENTS=1024 UNITS=4"
  "launch_rules UNITS=4 WINDOW_REMEDY=0"
  "tile_walk CONTENTS=1"
  "tile_walk TILE_ORDER=1"
  "tile_walk CONTENTS=128 HELD_LIMIT=40 TILE_ORDER=1 SIZE_BITS=8"
  "frame_port"
  "controller UNITS=1"
  "controller UNITS=4 POLICY=1 BATCH=256 TRAVERSER_SHADES=1 CULLING=1 TILE_ORDER=1"
  "controller UNITS=2 CONTENTS=1 RAY_POOL_SIZE=1 INTERSECTION_POOL_SIZE=1 HELD_LIMIT=1"
  "controller UNITS=2 CONTENTS=1024 POLICY=1 CULLING=1"
  "memory_port"
  "memory_port QUEUE=1 TRAVERSER_QUEUE=1 CYCLES_PER_BEAT=1 LATENCY=1"
  "memory_port QUEUE=64 CYCLES_PER_BEAT=64 LINES=1"
  "tree_cache"
  "tree_cache LANES=1 SLOTS=1 LINES=4 WAYS=2 MSHRS=1 LINE_BITS=3 DATA_BITS=8"
  "tree_cache LANES=32 SLOTS=256 MSHRS=32"
  "tree_banks"
  "tree_banks LANES=1 SLOTS=1 LINES=4 WAYS=2 MSHRS=1 BANKS=1 LINE_BITS=3 DATA_BITS=8"
  "lane_stacks"
  "lane_stacks SLOTS=1 ENTRIES=8 KEY_BITS=1 REFERENCE_BITS=2 BLOCK_BITS=1"
  "lane_stacks SLOTS=5 ENTRIES=9 KEY_BITS=21"
  "traverser_lane"
  "traverser_lane SLOTS=1 ENTRIES=8 BITS=6 LINE_BITS=8 BLOCK_BITS=1"
  "ray_setup"
  "ray_setup BITS=6 TAG_BITS=1"
  "ray_setup BITS=16"
  "ray_finish"
  "triangle_edges"
  "triangle_pipe BITS=26 TAG_BITS=1"
  "box_pipe BITS=6"
  "box_pipe BITS=12"
  "box_pipe BITS=16"
)
# Blocks that Yosys takes longest for.
large_configurations=(
  "tree_banks LANES=3 LINES=64 WAYS=2 MSHRS=16 BANKS=16"
  "tree_banks LANES=32 SLOTS=256 MSHRS=64 BANKS=2"
  "lane_stacks SLOTS=256 ENTRIES=64 BLOCK_BITS=16"
  "traverser_lane SLOTS=256 ENTRIES=64 BITS=16 LINE_BITS=28"
  "ray_finish TAG_BITS=1"
  "triangle_pipe BITS=32"
)
chip_configurations=(
  "chip WARPS=2 LANES=2 MISS_RECORDS=1"
  "chip UNITS=2 WARPS=1 LANES=1 POLICY=1 SHADING=1 CULLING=1 TILE_ORDER=1 RAY_POOL_SIZE=1 RAY_POOL_PIPELINED=1"
  "chip WARPS=1 LANES=1 TRAVERSER=1 TRAVERSER_LANES=1 TRAVERSER_SLOTS=1 TRAVERSER_TRIANGLE_PIPES=1 TRAVERSER_BANKS=1"
  "traverser LANES=1 SLOTS=1 BITS=6 TRIANGLE_PIPES=1 NODE_LINES=4 NODE_WAYS=2 NODE_MSHRS=1 NODE_BANKS=1 POOL=1"
  "traverser LANES=3 SLOTS=5 TRIANGLE_PIPES=2 TRIANGLE_MSHRS=8 POOL=9 RECORD_WORDS=16 SHADING=1 CULLING=1"
)

# each COMMAND CONFIGURATION...: COMMAND with each of them, its words apart.
each() {
  local command=$1 words configuration; shift
  for configuration in "$@"; do
    read -r -a words <<< "$configuration"
    "$command" "${words[@]}"
  done
}

# The rest take a module and its parameters.
read_by_simulators() {
  local top=$1; shift
  check "verilator $top $*" verilator --lint-only -Wall --default-language 1364-2005 -Irtl/include rtl/waivers.vlt \
    "${@/#/-G}" --top-module "rp_$top" "${rtl[@]}"
  check "iverilog $top $*" iverilog -g2005 -Wall -Irtl/include -o /dev/null "${@/#/-Prp_$top.}" -s "rp_$top" "${rtl[@]}"
}

# Synthesis view, of the whole in one piece: no latch, no combinational loop, no undriven or doubly driven net.
read_by_yosys() {
  local top=$1 flags=() parameter; shift
  for parameter in "$@"; do flags+=(-chparam "${parameter%=*}" "${parameter#*=}"); done
  check "yosys $top $*" yosys -q -e '.*latch.*' -p "
    read_verilog -defer -DSYNTHESIS -DNO_CLOCK_GATES -Irtl/include ${rtl[*]}
    hierarchy -check -top rp_$top ${flags[*]}; proc -noopt; flatten; opt_clean
    select -assert-none t:\$dlatch t:\$adlatch t:\$dlatchsr; check -assert"
}

check_verilog() {
  local units=("${unit_configurations[@]/#/multiprocessor }")
  local all=("${units[@]}" "${chip_configurations[@]}" "${large_configurations[@]}" "${small_configurations[@]}")
  echo "lint: ${#rtl[@]} Verilog files, ${#all[@]} configurations by two tools, ${#small_configurations[@]} by a third"
  each read_by_simulators "${all[@]}"
  each read_by_yosys "${small_configurations[@]}"
}
check_lint_units() { each read_by_yosys "${unit_configurations[@]/#/multiprocessor }"; }
check_lint_chip() { each read_by_yosys "${chip_configurations[@]}"; }
check_lint_blocks() { each read_by_yosys "${large_configurations[@]}"; }

check_pages() {
  check "table of modules" scripts/module_table.py
  check "what the pages name" scripts/pages.py
  check "layers of the sources" scripts/layers.py
  check "licences of what others carry away" scripts/licences.sh
}

check_columns() { check "lines of at most 120 columns" scripts/columns.sh; }

check_python() {
  local files
  mapfile -t files < <(scripts/sources.sh python)
  check "flake8, ${#files[@]} files" flake8 "${files[@]}"
}

check_shell() {
  local files
  mapfile -t files < <(scripts/sources.sh shell)
  check "shellcheck, ${#files[@]} files" shellcheck "${files[@]}"
}

# clang-tidy reads each source as the build compiles it; what only the build generates (Verilated models) is left to
# the compiler.
check_cpp() {
  local cpp
  mapfile -t cpp < <(scripts/sources.sh cpp)
  check "clang-format (make format), ${#cpp[@]} files" clang-format --dry-run -Werror "${cpp[@]}"
  local since
  since=$(scripts/passed.sh)
  check "clang-tidy, what has changed since ${since:0:12}" scripts/tidy.py "$build" --since "$since"
}

[ $# -gt 0 ] || echo "lint: $(last_duration lint)"
mapfile -t rtl < <(scripts/sources.sh verilog)
for kind in "${chosen[@]}"; do "check_$kind"; done
wait
[ $# -gt 0 ] || keep_duration lint
# The last lines are the ones that are read.
if [ -s "$failed" ]; then
  printf 'lint: %d of %d checks are not clean; their output stands above:\n' "$(wc -l < "$failed")" "$checks"
  sort "$failed" | sed 's/^/  /'
  exit 1
fi
echo "lint: all $checks checks are clean, in $SECONDS s"
