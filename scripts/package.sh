#!/bin/bash
# Builds the Debian packages raypool and raypool-dev, for any computer of this architecture: scripts/package.sh FOLDER
# FOLDER is a build folder of its own, and gets them. Installed, they need nothing of it.
set -eu -o pipefail
cd "$(dirname "$0")/.."
mkdir -p "$1"
folder=$(realpath "$1")
log=$folder/package.log
# shellcheck source=scripts/build_place.bash
. scripts/build_place.bash
leave_place "$folder"
run() { "$@" > "$log" 2>&1 || { cat "$log" >&2; exit 1; }; }
echo 'building raypool for any computer; the first time this takes minutes'
run cmake -S . -B "$folder" -G Ninja -DCMAKE_BUILD_TYPE=Release -DRAYPOOL_TESTS=OFF -DRAYPOOL_NATIVE=OFF
run cmake --build "$folder"
run cpack --config "$folder/CPackConfig.cmake" -B "$folder"
printf 'install with: apt-get install %s\n' "$folder"/raypool_*.deb
printf 'and to link the model: apt-get install %s\n' "$folder"/raypool-dev_*.deb
