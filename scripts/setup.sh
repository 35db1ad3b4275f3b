#!/bin/bash
# Installs the Debian packages of the named groups of scripts/packages.txt that are not there yet:
# scripts/setup.sh sim test
# Prints nothing and takes milliseconds when nothing is missing. Needs root, or sudo; else prints the line to run and
# ends with 1.
set -eu -o pipefail
cd "$(dirname "$0")/.."

wanted=()
for group in "$@"; do
  mapfile -t names < <(awk -v group="$group" '$1 == group { print $2 }' scripts/packages.txt)
  [ ${#names[@]} -gt 0 ] || { echo "setup: scripts/packages.txt has no group '$group'" >&2; exit 1; }
  wanted+=("${names[@]}")
done
if [ ${#wanted[@]} = 0 ]; then
  groups=$(awk '/^[a-z]/ { print $1 }' scripts/packages.txt | sort -u | paste -sd ' ')
  echo "usage: scripts/setup.sh GROUP... (groups: $groups)" >&2
  exit 1
fi

if ! command -v dpkg-query > /dev/null; then
  echo "setup: this is not Debian, so nothing is installed; what is needed has these Debian names: ${wanted[*]}" >&2
  exit 0
fi

installed=$(dpkg-query -W -f='${db:Status-Abbrev} ${Package}\n' "${wanted[@]}" 2> /dev/null |
  awk '$1 == "ii" { print $2 }' || true)
mapfile -t missing < <(printf '%s\n' "${wanted[@]}" | sort -u | grep -vxF -e "${installed:-nothing}" || true)
[ ${#missing[@]} -gt 0 ] || exit 0

as_root=()
if [ "$(id -u)" != 0 ]; then
  by_hand="sudo apt-get install --no-install-recommends ${missing[*]}"
  if ! command -v sudo > /dev/null || { [ ! -t 0 ] && ! sudo -n true 2> /dev/null; }; then
    printf 'setup: packages are missing and this user may not install them; run:\n  %s\n' "$by_hand" >&2
    exit 1
  fi
  as_root=(sudo)
fi

# A fresh image has no package lists, an old one has lists that name files which are
# gone: then fetch them and try again.
apt() {
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq -o DPkg::Lock::Timeout=300 -o Dpkg::Use-Pty=0 "$@"
}
install() { apt install -y --no-install-recommends "${missing[@]}" > "$log" 2>&1; }
log=$(mktemp)
trap 'rm -f "$log"' EXIT
echo "setup: installing ${missing[*]}"
if ! install; then
  apt update > "$log" 2>&1 && install ||
    { cat "$log" >&2; echo "setup: apt-get could not install: ${missing[*]}" >&2; exit 1; }
fi
