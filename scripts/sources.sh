#!/bin/bash
# Prints the project's source files of one language, one a line: scripts/sources.sh cpp|verilog|shell|python|text|pages
# text: all but the pages that is read by lines of at most 120 columns.
set -eu -o pipefail
cd "$(dirname "$0")/.."
files() {
  case $1 in
    cpp) find cpp_model sim studies program tb bench examples -name '*.cpp' -o -name '*.hpp' ;;
    verilog) find rtl -name '*.v' ;;
    shell) find scripts studies tb .ci -type f \( -name '*.sh' -o -name '*.bash' -o -name run \) ;;
    python) find scripts studies -name '*.py' ;;
    text)
      files cpp; files shell; files python
      find rtl tb -name '*.v' -o -name '*.vh' -o -name '*.vlt'
      echo Makefile; echo studies/studies.mk
      find CITATION.cff Dockerfile .editorconfig .pre-commit-config.yaml .github -type f ! -name '*.md'
      find CMakeLists.txt cmake cpp_model sim studies program tb examples -name CMakeLists.txt -o -name '*.cmake'
      ;;
    pages) find ./*.md docs examples .github -name '*.md' | sed 's|^\./||' ;;
    *) echo "usage: scripts/sources.sh cpp|verilog|shell|python|text|pages" >&2; exit 1 ;;
  esac
}
files "${1:-}" | sort
