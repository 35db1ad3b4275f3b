#!/bin/bash
# scripts/setup.sh: silent when nothing is missing; as root installs what is missing and fetches lists only when it
# must; else prints what to run. Works on a copy with a package manager that only writes down what it is asked.
set -u -o pipefail
cd "$(dirname "$0")/../.." || exit 1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
mkdir -p "$folder/scripts" "$folder/bin"
cp scripts/setup.sh "$folder/scripts/"
printf 'a one present\na two missing\nb one present\n' > "$folder/scripts/packages.txt"
cat > "$folder/bin/dpkg-query" <<'END'
#!/bin/bash
for name in "$@"; do [ "$name" != one ] || echo "ii  one"; done
exit 1
END
cat > "$folder/bin/apt-get" <<'END'
#!/bin/bash
echo "$*" >> "$CALLS"
case "$* " in *install*) [ -e "$CALLS.lists" ] ;; *update*) : > "$CALLS.lists" ;; esac
END
# shellcheck disable=SC2016 # the script expands it
printf '#!/bin/bash\necho "$FAKE_UID"\n' > "$folder/bin/id"
chmod +x "$folder/bin/"*
export CALLS=$folder/calls FAKE_UID=0
failures=0
expect() {
  [ "$2" = "$3" ] || { failures=$((failures + 1)); printf 'FAILED: %s: wanted [%s], got [%s]\n' "$1" "$2" "$3"; }
}
setup() { PATH=$folder/bin:$tools "$folder/scripts/setup.sh" "$@" 2>&1 < /dev/null; }
# Without sudo, whatever this machine has: a folder of links to the tools that the script uses.
tools=$folder/tools
mkdir "$tools"
for tool in bash awk sort grep mktemp rm cat dirname env paste printf cut; do
  ln -s "$(command -v "$tool")" "$tools/"
done

expect "nothing missing is silent" "" "$(setup b)"
expect "nothing missing calls no package manager" "" "$(cat "$CALLS" 2> /dev/null)"
setup a > /dev/null; expect "missing packages are installed" 0 $?
expect "lists are fetched after a first try" "install update install" \
  "$(grep -oE '(install -y|update$)' "$CALLS" | cut -d ' ' -f 1 | paste -sd ' ')"
expect "only what is missing, without recommended packages" 2 "$(grep -cE -- '--no-install-recommends two$' "$CALLS")"
: > "$CALLS"; setup a > /dev/null
expect "lists that serve are not fetched again" "install" \
  "$(grep -oE '(install -y|update$)' "$CALLS" | cut -d ' ' -f 1 | paste -sd ' ')"
text=$(FAKE_UID=1000 setup a); expect "a plain user cannot install" 1 $?
expect "and reads the line to run" 1 "$(grep -c 'sudo apt-get install --no-install-recommends two$' <<< "$text")"
setup c > /dev/null; expect "an unknown group is refused" 1 $?
[ "$failures" = 0 ]
