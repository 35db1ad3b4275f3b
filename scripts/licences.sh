#!/bin/bash
# Prints every file of rtl/, and every header and source that is installed, that does not begin with its licence and
# copyright, and ends with 1 if there is one: scripts/licences.sh
set -eu -o pipefail
cd "$(dirname "$0")/.."
mapfile -t files < <({
  find rtl -type f
  find cpp_model sim/lockstep -name '*.hpp' ! -name 'test_*.hpp'
  grep -oE '(sim/rtl|cpp_model)/[a-z_/]+\.(cpp|hpp|vlt)' cmake/install.cmake
} | sort -u)
missing=0
for file in "${files[@]}"; do
  head -2 "$file" | tr '\n' '|' |
    grep -qE '^// SPDX-License-Identifier: Apache-2\.0\|// SPDX-FileCopyrightText: 20[0-9]{2} raypool maintainers\|$' ||
    { echo "$file: does not begin as rtl/chip/rp_chip.v does: licence and copyright"; missing=1; }
done
exit $missing
