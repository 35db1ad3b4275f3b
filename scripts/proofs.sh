#!/bin/bash
# Runs every proof in tb/proofs: scripts/proofs.sh [NAME...], NAME as in tb/proofs/NAME.sh; exit code 1 if one fails.
set -eu -o pipefail
cd "$(dirname "$0")/.."
names=("$@")
[ ${#names[@]} -gt 0 ] || for file in tb/proofs/*.sh; do names+=("$(basename "$file" .sh)"); done
failed=0
for name in "${names[@]}"; do
  [ -x "tb/proofs/$name.sh" ] || { echo "proofs.sh: there is no proof '$name'; see tb/proofs/*.sh" >&2; exit 1; }
  "tb/proofs/$name.sh" || failed=1
done
exit $failed
