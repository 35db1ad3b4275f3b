# For scripts that replay a recording in Icarus; sourced in the project's folder.

# need_icarus: names what is missing.
need_icarus() {
  local tool
  for tool in iverilog vvp; do
    command -v $tool > /dev/null ||
      { echo "$(basename "$0"): $tool was not found: install it (Debian package iverilog)" >&2; exit 1; }
  done
}

# compile_replay BENCH FOLDER KEPT PARAMETER...: FOLDER/BENCH.vvp, of the Verilog in RTL (default: rtl). PARAMETER:
# NAME=VALUE, of what is replayed. KEPT: those that are parameters of the bench too.
compile_replay() {
  local bench=$1 folder=$2 kept=$3 list='' parameter own=()
  shift 3
  for parameter in "$@"; do
    list+="${list:+, }.${parameter%=*}(${parameter#*=})"
    [[ " $kept " != *" ${parameter%=*} "* ]] || own+=("-P$bench.$parameter")
  done
  local macro=${bench%_replay}
  iverilog -g2005 -Wall -Wno-timescale -I"${RTL:-rtl}/include" -Itb/icarus -s "$bench" \
    -D"${macro^^}_PARAMETERS=$list" "${own[@]}" -o "$folder/$bench.vvp" "tb/icarus/$bench.v" "${RTL:-rtl}"/*/*.v
}

# replay BENCH FOLDER WHAT: replays FOLDER/vectors.txt; WHAT: of what, in messages.
replay() {
  local result
  result=$(vvp -n "$2/$1.vvp" +vectors="$2/vectors.txt")
  echo "$3: $result"
  # A bench that stops early prints nothing.
  grep -q 'as recorded' <<< "$result" ||
    { echo "$(basename "$0"): FAILED; the recording is $2/vectors.txt" >&2; exit 1; }
}
