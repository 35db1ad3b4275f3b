#!/bin/bash
# Runs every proof in tb/proofs: scripts/proofs.sh [NAME...], NAME as in tb/proofs/NAME.sh; exit code 1 if one fails.
set -eu -o pipefail
cd "$(dirname "$0")/.."
. scripts/duration.bash
names=("$@")
[ ${#names[@]} -gt 0 ] || for file in tb/proofs/*.sh; do names+=("$(basename "$file" .sh)"); done
failed=0
[ $# -gt 0 ] || echo "proofs.sh: ${#names[@]} proofs, each of several parts: ${names[*]}; $(last_duration proofs)"
for name in "${names[@]}"; do
  begin=$SECONDS
  [ -x "tb/proofs/$name.sh" ] || { echo "proofs.sh: there is no proof '$name'; see tb/proofs/*.sh" >&2; exit 1; }
  "tb/proofs/$name.sh" || failed=1
  echo "proofs.sh: $name took $((SECONDS - begin)) s"
done
[ $# -gt 0 ] || keep_duration proofs
exit $failed
