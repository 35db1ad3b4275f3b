#!/bin/bash
# Writes man page and completion of the command line, as the program describes
# itself: scripts/describe.sh RAYPOOL FOLDER
set -eu -o pipefail
raypool=$1 folder=$2
mkdir -p "$folder"
for shell in bash zsh fish; do "$raypool" completion "$shell" > "$folder/raypool.$shell"; done
"$raypool" man | gzip -9n > "$folder/raypool.1.gz"
