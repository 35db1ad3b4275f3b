#!/bin/bash
# Prints every line of the sources that is longer than 120 columns, and ends with 1 if there is one.
set -eu -o pipefail
cd "$(dirname "$0")/.."
export LC_ALL=C.UTF-8   # columns, not bytes
mapfile -t files < <(scripts/sources.sh text)
! grep -HnE '.{121}' "${files[@]}"
