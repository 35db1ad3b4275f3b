#!/bin/bash
# Builds targets and shows the progress: scripts/build.sh BUILD [TARGET]... (default: all). On a terminal one line that
# is rewritten, elsewhere one every ten seconds, on standard error. A second one in the same folder waits.
set -eu -o pipefail
build=$1
shift
# shellcheck source=scripts/build_place.bash
. "$(dirname "$0")/build_place.bash"
was=$(made_elsewhere "$build")
if [ -n "$was" ]; then
  echo "build.sh: the build folder \"$build\" was made for $was: let make, or scripts/configure.sh, configure it" >&2
  exit 1
fi
take_turn "$build"
width=$(tput cols 2> /dev/null || echo 80)
show() {
  local shown=
  [ ! -t 2 ] || shown=yes
  local next=$((SECONDS + 10)) line
  while IFS= read -r line; do
    case $line in
      '['*/*']'*)
        if [ -n "$shown" ]; then
          printf '\r\033[K%s' "${line:0:width-1}" >&2
        elif [ "$SECONDS" -ge "$next" ]; then
          echo "${line:0:width-1}" >&2
          next=$((SECONDS + 10))
        fi
        ;;
      'ninja: no work to do.' | *'GLOB mismatch'* | '-- '*) ;;
      *) printf '%s%s\n' "${shown:+$'\r\033[K'}" "$line" >&2 ;;
    esac
  done
  printf '%s' "${shown:+$'\r\033[K'}" >&2
}
cmake --build "$build" ${1+--target "$@"} 2>&1 9>&- | show
