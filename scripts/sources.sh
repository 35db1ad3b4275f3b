#!/bin/bash
# Prints the project's source files of one language, one a line: scripts/sources.sh cpp|verilog|shell|python
set -eu -o pipefail
cd "$(dirname "$0")/.."
case $1 in
  cpp) find cpp_model sim tb bench examples -name '*.cpp' -o -name '*.hpp' ;;
  verilog) find rtl -name '*.v' ;;
  shell) find scripts .ci -type f \( -name '*.sh' -o -name run \) ;;
  python) find scripts -name '*.py' ;;
  *) echo "usage: scripts/sources.sh cpp|verilog|shell|python" >&2; exit 1 ;;
esac | sort
