#!/bin/bash
# Builds the Verilated multiprocessor of one set of Verilog parameters: OUTPUT_DIR/libraypool_unit.so; or the Verilated
# chip: OUTPUT_DIR/libraypool_chip.so.
#   scripts/verilate.sh OUTPUT_DIR [--top chip] [--trace] [--quick] [--netlist FILE]... NAME=VALUE...
# NAME=VALUE as `raypool config CONFIG --verilog-parameters` prints them, and UNITS=1|2|4 (default 1); of a chip as
# chip_verilog_parameters() has them.
# --netlist: SystemVerilog (.sv) that stands in for the compute unit of rtl/, or for the chip, and calls
# sim/rtl/gate_simulator.cpp.
# --trace: the unit can write waveforms (FST), and is slower. --quick: compiled in less time, slower. Nothing is built
# when all it is made from is as it was; a build that fails leaves the old library as it was. VERILATOR, CXX and JOBS
# (default 2) choose the tools and the number of compilers.
set -eu -o pipefail

fail() {
  echo "verilate.sh: $*" >&2
  exit 1
}

usage="usage: scripts/verilate.sh OUTPUT_DIR [--top chip] [--trace] [--quick] [--netlist FILE]... NAME=VALUE..."
[ $# -ge 1 ] || fail "$usage"
output=$1
shift
top=multiprocessor
kind=unit
trace=0
quick=0
parameters=()
netlist=()
while [ $# -gt 0 ]; do
  argument=$1
  shift
  if [ "$argument" = --top ]; then
    case ${1:-} in
      multiprocessor) kind=unit ;;
      chip) kind=chip ;;
      *) fail "--top is '${1:-}': there are multiprocessor, which is the default, and chip" ;;
    esac
    top=$1
    shift
  elif [ "$argument" = --trace ]; then
    trace=1
  elif [ "$argument" = --quick ]; then
    quick=1
  elif [ "$argument" = --netlist ]; then
    [ $# -ge 1 ] || fail "--netlist needs a file"
    netlist+=("$(realpath "$1")")
    shift
  elif [[ $argument =~ ^[A-Z][A-Z0-9_]*=[0-9]+$ ]]; then
    parameters+=("$argument")
  else
    fail "'$argument' is neither --top, --trace, --quick nor a Verilog parameter such as WARPS=8"
  fi
done

verilator=${VERILATOR:-verilator}
jobs=${JOBS:-2}
version=$("$verilator" --version 2> /dev/null) ||
  fail "verilator was not found: install it (Debian package verilator) or set VERILATOR to its path"
command -v make > /dev/null || fail "make was not found: install it (Debian package make)"
compiler=${CXX:-g++}
compiler_version=$("$compiler" --version 2> /dev/null | head -n 1) ||
  fail "the C++ compiler '$compiler' was not found: install g++ or set CXX"

mkdir -p "$output"
output=$(cd "$output" && pwd)
root=$(cd "$(dirname "$0")/.." && pwd)
library=$output/libraypool_$kind.so
stamp=$output/libraypool_$kind.stamp

# Everything the library is made from.
cd "$root"
shopt -s nullglob
headers=(cpp_model/{bits,enum_array}.hpp cpp_model/isa/{isa,counters,input_error}.hpp \
  cpp_model/config/{configuration,parameters}.hpp \
  cpp_model/machine/{compute/compute_unit,common/memory,common/packages}.hpp \
  sim/rtl/{unit_library,verilated_design}.hpp)
wrapper=("sim/rtl/rtl_$kind.cpp" cpp_model/machine/compute/compute_unit.cpp)
verilog=(rtl/*/*.v)
waivers=(rtl/*.vlt)   # and what the lockstep looks at inside
shared=()             # the modules of which all instances have the same code
if [ "$kind" = chip ]; then
  headers+=(cpp_model/machine/chip/{chip_device,memory_port,ray_kernel}.hpp
    cpp_model/machine/common/{memory_line,port_cycles,ram_queue}.hpp sim/rtl/chip_library.hpp
    cpp_model/machine/traverser/{tree_setup,tree_lines,ray_setup,box_ray,triangle_ray,traverser_work}.hpp)
  wrapper+=(cpp_model/machine/chip/chip_device.cpp)
  waivers+=(sim/rtl/chip_probes.vlt)
  shared=(sim/rtl/shared_modules.vlt)
else
  waivers+=(sim/rtl/probes.vlt)
fi
what=rtl/
optimise=(OPT_FAST=-O2 OPT_SLOW=-O1 OPT_GLOBAL=-O2)
[ "$quick" = 0 ] || optimise=(OPT_FAST=-O1 OPT_SLOW=-O0 OPT_GLOBAL=-O2)
if [ ${#netlist[@]} -gt 0 ]; then
  replaced=compute_unit
  [ "$kind" = unit ] || replaced=chip
  verilog=("${netlist[@]}")
  for file in rtl/*/*.v; do [ "${file##*/}" = "rp_$replaced.v" ] || verilog+=("$file"); done
  what="the shell of a netlist"
  wrapper+=(sim/rtl/gate_simulator.cpp)
fi
# Instances share their code where gold folds functions that are alike.
fold=
if [ ${#shared[@]} -gt 0 ] && command -v ld.gold > /dev/null; then fold="-fuse-ld=gold -Wl,--icf=all"; fi
digest=$({
  printf '%s\n' "$version" "$compiler_version" "trace $trace quick $quick fold $fold" "${parameters[@]}"
  sha256sum "${verilog[@]}" "${waivers[@]}" "${shared[@]}" rtl/include/*.vh "${headers[@]}" "${wrapper[@]}" \
    scripts/verilate.sh
} | sha256sum | cut -d ' ' -f 1)
if [ -f "$library" ] && [ "$(cat "$stamp" 2> /dev/null)" = "$digest" ]; then
  touch "$library"   # raypool warns of one that is older than the Verilog
  echo "verilate.sh: $library is up to date"
  exit 0
fi

build=$(mktemp -d "$output/.verilate.XXXXXX")
trap 'rm -rf "$build"' EXIT
log=$build/log
run() {
  "$@" > "$log" 2>&1 && return
  cat "$log" >&2
  fail "$message; nothing was changed in $output"
}

begin=$SECONDS
echo "verilate.sh: verilating $what (${parameters[*]:-default parameters})"
units=1
for parameter in "${parameters[@]}"; do [ "${parameter%%=*}" != UNITS ] || units=${parameter#*=}; done
printf '#define RAYPOOL_BUILT_PARAMETERS "%s"\n#define RAYPOOL_UNIT_COUNT %d\n' "${parameters[*]}" "$units" \
  > "$build/built_parameters.h"
if [ ${#shared[@]} -gt 0 ]; then
  ports=$build/shared_ports.vlt
  {
    echo "\`verilator_config"
    sed -n 's/^no_inline -module "\(.*\)"$/\1/p' "${shared[@]}" | while read -r module; do
      sed -nE '/^ *input /{s,//.*,,; s/.*[^a-z0-9_]([a-z0-9_]+)[ ,)]*$/\1/p}' rtl/*/"$module.v" | grep -vx clk_i |
        sed "s/.*/public_flat_rd -module \"$module\" -var \"&\"/"
    done
  } > "$ports"
  shared+=("$ports")
fi
options=(--cc --exe --top-module "rp_$top" --prefix "V$top" --Mdir "$build" -Irtl/include
  --default-language 1364-2005 +1800-2017ext+sv
  -O3 --x-assign fast --x-initial fast --noassert
  -CFLAGS "-std=c++17 -fPIC -fvisibility=hidden -fno-gnu-unique -fno-plt -fno-semantic-interposition"
  -CFLAGS "-I$root/cpp_model -I$root/sim -I$build"
  -LDFLAGS "-shared -Wl,-Bsymbolic -Wl,-O1 $fold" -o "libraypool_$kind.so")
# Functions are alike if they work on nothing but their own: the longer they are, the less goes from one to the next.
[ ${#shared[@]} -eq 0 ] || options+=(--output-split-cfuncs 30000 -CFLAGS -ffunction-sections)
[ "$trace" = 0 ] || options+=(--trace-fst)
for parameter in "${parameters[@]}"; do options+=("-G$parameter"); done
[ ${#netlist[@]} -eq 0 ] || options+=(-Wno-lint -Wno-style -Wno-fatal)
message="verilator refused the hardware description (its messages are above)"
run "$verilator" "${options[@]}" "${waivers[@]}" "${shared[@]}" "${verilog[@]}" "${wrapper[@]/#/$root/}"

echo "verilate.sh: compiling $(cat "$build"/V"$top"*.cpp | wc -l) lines of C++ with $jobs compilers"
message="the Verilated $kind does not compile (messages above)"
launcher=
command -v ccache > /dev/null && launcher=ccache
run env CCACHE_BASEDIR="$build" CCACHE_NOHASHDIR=1 make -C "$build" -f "V$top.mk" -j "$jobs" CXX="$compiler" \
  LINK="$compiler" OBJCACHE="$launcher" "${optimise[@]}" "libraypool_$kind.so"

# The stamp goes first and comes last: an interrupted move never passes for a finished one.
rm -f "$stamp"
mv "$build/libraypool_$kind.so" "$library"
echo "$digest" > "$stamp"
echo "verilate.sh: built $library in $((SECONDS - begin)) s"
