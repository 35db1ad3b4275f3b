# Which place a build folder was made for, and whose turn it is there. CMake writes absolute paths into it: in a
# checkout that was copied or renamed they lead to the old one, where Ninja would configure and build.
# shellcheck shell=bash

# Until the caller ends no other one configures or builds in the folder; reports it if that takes longer than a moment:
# take_turn BUILD; what the caller starts gets 9>&-
take_turn() {
  exec 9> "$1/.lock"
  flock -w 1 9 || {
    echo "another make builds in the folder \"$1\": waiting for it" >&2
    flock 9
  }
}

# Where the checkout or the folder was, if it is another one than this script's and BUILD: made_elsewhere BUILD
made_elsewhere() {
  local cache=$1/CMakeCache.txt root key was
  root=$(dirname "${BASH_SOURCE[0]}")/..
  [ -f "$cache" ] || return 0
  for key in CMAKE_HOME_DIRECTORY CMAKE_CACHEFILE_DIR; do
    was=$(sed -n "s/^$key:INTERNAL=//p" "$cache")
    [ "$key" = CMAKE_HOME_DIRECTORY ] && [ "$was" -ef "$root" ] && continue
    [ "$key" = CMAKE_CACHEFILE_DIR ] && [ "$was" -ef "$1" ] && continue
    echo "${was:-another place}"
    return 0
  done
}

# Takes CMake's part out of such a folder and reports it; results and Verilated units, which hold no such paths, stay.
# The project's options in it, as words for CMake, are then in the array `kept`: leave_place BUILD
leave_place() {
  local was name
  was=$(made_elsewhere "$1")
  [ -n "$was" ] || return 0
  name=$(sed -n 's/^CMAKE_PROJECT_NAME:STATIC=//p' "$1/CMakeCache.txt")
  if [ "${name:-raypool}" != raypool ]; then
    echo "make: the build folder \"$1\" is one of $name: choose another one with BUILD=/path/elsewhere" >&2
    return 1
  fi
  # shellcheck disable=SC2034 # for the caller
  mapfile -t kept < <(sed -nE 's/^(RAYPOOL_[A-Z_]+:(BOOL|STRING)=.*)/-D\1/p' "$1/CMakeCache.txt")
  rm -rf "$1"/{,cpp_model/,sim/,studies/,program/,tb/}CMakeFiles
  rm -f "$1"/{CMakeCache.txt,build.ninja,.ninja_log,.ninja_deps}
  echo "make: the build folder \"$1\" was made for $was: it is configured and built again for $PWD; results stay" >&2
}
