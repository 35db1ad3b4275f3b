#!/bin/bash
# The build folder can be anywhere, and nothing is written elsewhere: scripts/tests/build_folder.sh BUILD, a
# folder in which the program is built.
# Where mounts are allowed (root), the checkout is made read-only around it for this test alone.
set -u -o pipefail
build=$(realpath "$1")
cd "$(dirname "$0")/../.." || exit 1
unset MAKEFLAGS MAKELEVEL MFLAGS RAYPOOL
folder=$(mktemp -d)
log=$folder/log
trap 'rm -rf "$folder"' EXIT

# A folder that cannot be made gets one sentence that names BUILD=, and make's own line.
if make run BUILD=/proc/none > "$log" 2>&1 || [ "$(wc -l < "$log")" != 2 ] ||
  ! grep -q 'build folder "/proc/none" cannot be written: choose another one with BUILD=' "$log"; then
  echo "FAILED: a build folder that cannot be made:"
  cat "$log"
  exit 1
fi
echo "ok: a build folder that cannot be made"

# What compilers print is shown, and the progress only where a line can be rewritten or time passes.
mkdir "$folder/bin"
printf '#!/bin/sh\nprintf "[1/2] Building a\\nx.cpp:1: error: e\\n[2/2] Linking b\\n"\nexit 1\n' > "$folder/bin/cmake"
chmod +x "$folder/bin/cmake"
if PATH=$folder/bin:$PATH scripts/build.sh "$folder" all 2> "$log" || [ "$(cat "$log")" != "x.cpp:1: error: e" ]; then
  echo "FAILED: a build that fails:"
  cat "$log"
  exit 1
fi
echo "ok: a build that fails"

# A call that waits for another one prints that, whether it configures or builds.
printf '#!/bin/sh\n' > "$folder/bin/cmake"
for waiting in "configure.sh $folder/shared OFF" "build.sh $folder/shared"; do
  mkdir -p "$folder/shared"
  flock "$folder/shared/.lock" sleep 3 &
  until ! flock -n "$folder/shared/.lock" true; do sleep 0.1; done
  # shellcheck disable=SC2086 # words
  if ! PATH=$folder/bin:$PATH scripts/$waiting 2> "$log" ||
    [ "$(cat "$log")" != "another make builds in the folder \"$folder/shared\": waiting for it" ] ||
    ! flock -n "$folder/shared/.lock" true; then
    echo "FAILED: $waiting in a folder where another one builds:"
    cat "$log"
    exit 1
  fi
done
echo "ok: a folder where another one builds"

read_only() {
  # shellcheck disable=SC2016 # the inner shell expands them
  unshare --mount bash -eu -c 'root=$PWD
    mount --bind "$0" "$0"
    mount --bind "$root" "$root"
    [[ $0 != "$root"/* ]] || mount --bind "$0" "$0"
    mount -o remount,bind,ro "$root"
    cd "$root"
    "$@"' "$build" "$@"
}
if ! read_only true 2> /dev/null; then
  echo "no read-only checkout: mounting needs root"
  exit 0
fi
if read_only touch README.md 2> /dev/null; then echo "FAILED: the checkout is not read-only"; exit 1; fi
for command in "make run KERNEL=saxpy ENGINE=functional" "make sim SCENE=cornell SIZE=8x8 ENGINE=native"; do
  # shellcheck disable=SC2086 # words
  if ! read_only $command "BUILD=$build" > "$log" 2>&1; then
    echo "FAILED: $command in a checkout that is read-only:"
    cat "$log"
    exit 1
  fi
  echo "ok: $command in a checkout that is read-only"
done
