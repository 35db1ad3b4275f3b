#!/bin/bash
# The last commit that passed .ci/run on this machine, as far as it is known: scripts/passed.sh [--keep]
# Prints it; where none is known that HEAD stands on, the last commit that is a working day (eight hours) older than
# HEAD, or else an empty tree. --keep: HEAD has passed. RAYPOOL_BASE, a commit, overrides what is kept in the file
# RAYPOOL_PASSED (default: in the user's cache).
set -eu -o pipefail
cd "$(dirname "$0")/.."
file=${RAYPOOL_PASSED:-${XDG_CACHE_HOME:-${HOME:-/tmp}/.cache}/raypool/passed}
if [ "${1:-}" = --keep ]; then
  mkdir -p "$(dirname "$file")"
  git rev-parse HEAD > "$file"
  exit 0
fi
for commit in "${RAYPOOL_BASE:-}" "$(cat "$file" 2> /dev/null || true)"; do
  if [ -n "$commit" ] && git merge-base --is-ancestor "$commit" HEAD 2> /dev/null; then
    git rev-parse "$commit"
    exit 0
  fi
done
before=$(($(git log -1 --format=%ct HEAD) - 8 * 3600))
commit=$(git rev-list -1 --before="$before" HEAD)
echo "${commit:-$(git hash-object -t tree /dev/null)}"
