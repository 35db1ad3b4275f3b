#!/bin/bash
# docs/develop/add-an-alu.md works as it stands: scripts/tests/add_an_alu.sh FOLDER
# Does what the page's marked blocks ask for, in FOLDER/tree. Then looks at what the page does not show: the report, a
# refused configuration, the set of configurations, the tests of random programs, and what Verilator warns of.
set -eu -o pipefail
# shellcheck source=scripts/tests/page_steps.bash
. "$(dirname "$0")/page_steps.bash"
copy_sources "$1"
follow_page docs/develop/add-an-alu.md
[ $new -ge 3 ] && [ $inserted -ge 2 ] && [ $ran -ge 4 ] && [ $expected -ge 10 ] && [ $replaced -ge 1 ] ||
  fail "the page lost blocks: $(steps)"

take run 'build/raypool sim --scene cornell --size 8x8 --depth 1 --config boxes.json --engine model --out out --quiet'
grep -q '"box": *{' out/report.json || fail "out/report.json does not name the ALU box"
take 'run, fails' "echo '{\"alus\": {\"box\": {\"depth\": 1}}}' > shallow.json; build/raypool config shallow.json"
grep -q 'alus.box.depth is 1; it must be an integer from 2 to 32' "$output" ||
  { cat "$output"; fail "a depth of 1 is not refused"; }
take run 'build/raypool configurations'
grep -q '; tid brh int flt slw box as count/latency/depth, ' "$output" ||
  { cat "$output"; fail "the set of configurations has no column for box"; }
lint='verilator --lint-only -Wall --default-language 1364-2005'
take run "$lint -Irtl/include rtl/waivers.vlt --top-module rp_multiprocessor rtl/*/*.v"
[ ! -s "$output" ] || { cat "$output"; fail "Verilator warns of the page's module"; }
take run 'scripts/configure.sh build ON -DRAYPOOL_UNIT_BENCHES=OFF; cmake --build build --target raypool_cosim_test'
take run "build/sim/raypool_cosim_test --gtest_filter='RandomPrograms.*:Covering*'"
echo "$(steps), as the page has them"
