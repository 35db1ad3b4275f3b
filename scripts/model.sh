#!/bin/bash
# Verilates one model of a bench: scripts/model.sh FOLDER CLASS VERILATOR [ARGUMENT]...
# FOLDER gets CLASS.h, CLASS.mk and CLASS.depends, the sources that Verilator read, as a rule of make. Prints only what
# goes wrong.
set -eu -o pipefail
[ $# -ge 3 ] || { echo "usage: scripts/model.sh FOLDER CLASS VERILATOR [ARGUMENT]..." >&2; exit 1; }
folder=$1 class=$2 verilator=$3
shift 3
rm -rf "$folder"
mkdir -p "$folder"
"$verilator" --cc --prefix "$class" --Mdir "$folder" "$@" > "$folder/log" 2>&1 || { cat "$folder/log" >&2; exit 1; }
sed -E "s|^.* : |$folder/$class.h: |" "$folder/${class}__ver.d" > "$folder/$class.depends"
