#!/bin/bash
# Builds a test program, then runs it: scripts/built_test.sh BUILD TARGET PROGRAM [ARGUMENT]...
set -eu -o pipefail
[ $# -ge 3 ] || { echo "usage: scripts/built_test.sh BUILD TARGET PROGRAM [ARGUMENT]..." >&2; exit 1; }
"$(dirname "$0")/build.sh" "$1" "$2"
shift 2
exec "$@"
