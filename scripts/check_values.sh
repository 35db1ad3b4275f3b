#!/bin/bash
# Refuses variables of a target of make that cannot be right before anything is built for them:
# scripts/check_values.sh TARGET [VARIABLE]...; without variables, all of a frame. Reads them from the environment. What
# costs more than a look at a file is left to the program: fields of SET, what a scene holds, what an engine can do.
# Prints one sentence and ends with 1, or prints nothing.
set -eu -o pipefail
cd "$(dirname "$0")/.."

target=$1
shift
refuse() {
  echo "make $target: $*" >&2
  exit 1
}
if [ $# -gt 0 ]; then
  for name in SCENE CONFIG SIZE DEPTH CUS TRAVERSER ENGINE BOUNDARY HITS THREADS VIEW EYE LOOK_AT UP FOV LIGHT DETAIL
  do
    [[ " $* " == *" $name "* ]] || unset "$name"
  done
fi

# The choices that the Makefile lists for a variable, "1|2|4".
choices() { sed -nE "s/^#:   $1=([a-z0-9|]+)( .*|)$/\1/p" Makefile; }

# near NAME CANDIDATE...: a question for the one that is like it, where Python is there to find it.
near() {
  python3 -c 'import difflib, os, sys
given, *known = sys.argv[1:]
names = {os.path.splitext(os.path.basename(name))[0]: name for name in known}
names.update((os.path.basename(name), name) for name in known)
close = difflib.get_close_matches(os.path.basename(given), names, 1)
print("".join(f": did you mean {names[name]}?" for name in close), end="")' "$@" 2> /dev/null || true
}

for name in ENGINE BOUNDARY CUS TRAVERSER HITS; do
  value=${!name-}
  IFS='|' read -ra listed <<< "$(choices "$name")"
  [ -z "$value" ] || [[ " ${listed[*]} " == *" $value "* ]] ||
    refuse "$name=$value is none of: ${listed[*]}$(near "$value" "${listed[@]}")"
done

number='[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?'
# whole NAME LEAST MOST
whole() {
  local value=${!1-}
  [ -z "$value" ] || { [[ $value =~ ^[0-9]{1,9}$ ]] && ((10#$value >= $2 && 10#$value <= $3)); } ||
    refuse "$1=$value: give a number from $2 to $3"
}
whole DEPTH 1 254
whole THREADS 1 256
if [ -n "${SIZE-}" ]; then
  [[ $SIZE =~ ^([0-9]{1,5})x([0-9]{1,5})$ ]] ||
    refuse "SIZE=$SIZE is not WIDTHxHEIGHT in pixels: write for example 256x256"
  for side in "${BASH_REMATCH[@]:1}"; do
    ((10#$side >= 1 && 10#$side <= 16384)) || refuse "SIZE=$SIZE: each side has 1 to 16384 pixels"
  done
fi
for name in DETAIL FOV; do
  value=${!name-}
  [ -z "$value" ] || [[ $value =~ ^$number$ ]] || refuse "$name=$value: give a number"
done
for name in EYE LOOK_AT UP LIGHT; do
  value=${!name-}
  [ -z "$value" ] || [[ $value =~ ^$number,$number,$number$ ]] ||
    refuse "$name=$value: give three numbers with commas between, as in 1,2.5,-3"
done

shopt -s nullglob nocaseglob
view=${VIEW-}
[ -z "$view" ] || [ -e "$view" ] ||
  refuse "VIEW=$view: there is no such file$(near "$view" "$(dirname "$view")"/*.json configs/views/*.json)"

config=${CONFIG-}
if [ -n "$config" ] && [ ! -f "$config" ]; then
  folders=(configs)
  [ -z "${RAYPOOL_CONFIGS-}" ] || folders=("$RAYPOOL_CONFIGS" configs)
  known=()
  for folder in "${folders[@]}"; do known+=("$folder"/*.json); done
  if [[ $config == */* || $config == *.json ]]; then
    [ -e "$config" ] ||
      refuse "CONFIG=$config: there is no such file$(near "$config" "$(dirname "$config")"/*.json "${known[@]}")"
  else
    names=("${known[@]##*/}")
    names=("${names[@]%.json}")
    size='[0-9]{1,4}w[0-9]{1,4}c'
    [[ " ${names[*]} " == *" $config "* || $config =~ ^$size$ ]] ||
      { [[ $config =~ ^([A-Za-z][A-Za-z0-9]*)_$size$ ]] && [[ " ${names[*]} " == *" ${BASH_REMATCH[1]} "* ]]; } ||
      refuse "CONFIG=$config: no configuration of this name$(near "$config" "${names[@]}" "best_${config#*_}" \
        configs/cosim/*.json) (give one of configs/, NwMc for N warps of M lanes, best_NwMc, or the path of a JSON" \
        "file)"
  fi
fi

# As find_scene() of sim/scene/scene_files.hpp.
scene=${SCENE-}
if [ -n "$scene" ] && [[ $scene != cornell && $scene != room ]] && [ ! -e "$scene" ]; then
  folders=(.)
  if [[ $scene == /* ]]; then
    folders=('')
  else
    IFS=: read -ra own <<< "${SCENES:-scenes}"
    folders+=("${own[@]}" examples examples/scenes)
  fi
  known=()
  [[ $scene == */* ]] || known=(cornell room)
  for folder in "${folders[@]}"; do
    for ending in '' .obj .gltf .glb .ply .obj.xz .gltf.xz .glb.xz .ply.xz; do
      # What is packed the program refuses with how to unpack it.
      [ ! -f "$folder/$scene$ending" ] || exit 0
    done
    place=$folder
    [[ $scene != */* ]] || place=$folder/${scene%/*}
    for file in "$place"/*.{obj,gltf,glb,ply}; do known+=("${file#./}"); done
  done
  refuse "SCENE=$scene: there is no such scene$(near "$scene" "${known[@]}") (give cornell, room, or a .obj, .gltf," \
    ".glb or .ply file)"
fi
