#!/bin/bash
# docs/start/first-change.md works as it stands: scripts/tests/first_change.sh FOLDER
# Does what the page's marked blocks ask for, in FOLDER/tree. Then puts the broken line right, as the page asks, and
# looks at what the page does not show: the tests of the table, and what Verilator warns of.
set -eu -o pipefail
# shellcheck source=scripts/tests/page_steps.bash
. "$(dirname "$0")/page_steps.bash"
copy_sources "$1"
follow_page docs/start/first-change.md
[ $new -ge 1 ] && [ $replaced -ge 13 ] && [ $ran -ge 5 ] && [ $expected -ge 14 ] ||
  fail "the page lost blocks: $(steps)"

[ -n "$(find tb/regressions -name 'fifo-*')" ] || fail "the program that found the broken line is not in tb/regressions"
sed -i 's/INSTRUCTION_CACHE_LRU == 0/INSTRUCTION_CACHE_LRU != 0/' rtl/compute/rp_instruction_cache.v
lint='verilator --lint-only -Wall --default-language 1364-2005'
take run "$lint -Irtl/include rtl/waivers.vlt --top-module rp_multiprocessor rtl/*/*.v"
[ ! -s "$output" ] || { cat "$output"; fail "Verilator warns of the page's change"; }
take run 'scripts/build.sh build raypool_config_test && build/cpp_model/raypool_config_test --gtest_brief=1'
take run 'python3 scripts/tests/core_test.py build/raypool-tables'
echo "$(steps), as the page has them"
