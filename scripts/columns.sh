#!/bin/bash
# Prints every line of the sources and pages that is longer than 120 columns, and ends with 1 if there is one. In a page
# rows of tables, what is quoted or fenced, and pictures stay on their line.
set -eu -o pipefail
cd "$(dirname "$0")/.."
export LC_ALL=C.UTF-8   # columns, not bytes
mapfile -t files < <(scripts/sources.sh text)
mapfile -t pages < <(scripts/sources.sh pages)
long=$(
  grep -HnE '.{121}' "${files[@]}" || true
  python3 - "${pages[@]}" << 'END'
import sys
for page in sys.argv[1:]:
    fenced = False
    for number, line in enumerate(open(page, encoding="utf-8"), 1):
        fenced ^= line.startswith("```")
        if len(line) > 121 and not fenced and not line.startswith(("|", "    ", "![")):
            print(f"{page}:{number}:{line}", end="")
END
)
[ -z "$long" ] || { echo "$long"; exit 1; }
