#!/bin/bash
# Without an engine --error and --within choose one, say why, and leave what that engine leaves:
#   scripts/tests/engine_choice.sh RAYPOOL
set -u -o pipefail
raypool=$(realpath "$1")
cd "$(dirname "$0")/../.." || exit
# shellcheck source=scripts/tests/expect.bash
source scripts/tests/expect.bash
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
draw() { "$raypool" sim cornell --out "$folder/out" "$@"; }

# Same cycles, picture and engine as when it is named.
same_as() {
  local engine=$1
  shift
  "$raypool" sim cornell --quiet --out "$folder/chosen" "$@" &&
    "$raypool" sim cornell --quiet --out "$folder/named" --engine "$engine" "${@:3}" &&
    cmp "$folder"/{chosen,named}/image.png && python3 - "$folder" <<'END'
import json
import sys

chosen, named = (json.load(open(f"{sys.argv[1]}/{which}/report.json")) for which in ("chosen", "named"))
assert chosen.pop("engine_choice") and "engine_choice" not in named, chosen
for report in (chosen, named):
    for key in ("command", "wall_seconds", "simulation_seconds", "simulated_per_second"):
        report.pop(key, None)
assert chosen == named, {key: (chosen.get(key), named.get(key)) for key in chosen if chosen.get(key) != named.get(key)}
print("the same")
END
}
small=(--size 32x32) large=(--traverser static --depth 1)  # the latter has enough blocks for a sample
expect "a coarse error is estimated" 0 "engine estimate: its error with this traverser is 37%" draw --error 40% \
  "${small[@]}"
expect "a small frame is not sampled" 0 "engine model: a sample of so small a frame" draw --error 5% "${small[@]}"
expect "a large one is" 0 "engine sampled: an estimate's error is 14%" draw --error 5% "${large[@]}"
expect "much time suffices for model" 0 "engine model: the whole frame takes about" draw --within 9999s "${small[@]}"
expect "none for an estimate alone" 0 "engine estimate: the whole frame would take" draw --within 0.001s "${small[@]}"
expect "none for a sample either" 0 "engine estimate: the smallest sample would take" draw --within 0.001s "${large[@]}"
expect "estimate, left open" 0 "the same" same_as estimate --error 40% "${small[@]}"
expect "model, left open" 0 "the same" same_as model --within 9999 "${small[@]}"
expect "shaders are not estimated" 0 "engine model: " draw --error 50% "${small[@]}" --shaders whitted
expect "nor sampled where frames add up" 0 "neither sampled nor estimated" draw --within 50 --size 8x8 \
  --shaders whitted --samples 2
expect "what only some engines have" 1 "--waves is for an engine that has it, and --error leaves the engine open" \
  draw --error 5% --waves
[ "$failures" = 0 ]
