#!/bin/bash
# scripts/lint.sh does the kinds of checks that it is asked for, reports what is wrong, and refuses a kind that it does
# not know. Works on a copy with files that are wrong in one way each.
set -u -o pipefail
cd "$(dirname "$0")/../.." || exit 1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
mkdir -p "$folder"/{scripts,.ci,.github,rtl,cpp_model,sim,studies,program,tb,bench,examples,cmake,docs}
cp scripts/{lint,sources,columns}.sh scripts/duration.bash "$folder/scripts/"
cp .flake8 .shellcheckrc "$folder/"
touch "$folder"/{Makefile,studies/studies.mk,CMakeLists.txt,README.md,CITATION.cff,Dockerfile}
touch "$folder"/{.editorconfig,.pre-commit-config.yaml}
# shellcheck source=scripts/tests/expect.bash
. scripts/tests/expect.bash
lint() { "$folder/scripts/lint.sh" "$@"; }

# shellcheck disable=SC2016 # a script to be checked
unquoted='#!/bin/bash\nrm $1\n'
expect "what is right is clean" 0 "all 3 checks are clean" lint columns python shell
expect "a kind that there is not" 1 "'colums' is not a kind of check" lint colums
printf '%b' "$unquoted" > "$folder/scripts/unquoted.sh"
expect "a word that is not quoted" 1 "SC2086" lint shell
expect "... is none of Python's business" 0 "all 1 checks are clean" lint python
printf 'import os\nprint(nothing)\n' > "$folder/scripts/broken.py"
expect "a name that is not there" 1 "undefined name 'nothing'" lint python
printf '# %0119d\n' 0 > "$folder/scripts/long.py"
expect "a line of 121 columns" 1 "scripts/long.py:1:" lint columns
printf '# %0115dé—²\n' 0 > "$folder/scripts/long.py"
expect "120 columns in more bytes" 0 "all 1 checks are clean" lint columns
printf '| %0119d |\n\n    $ %0119d\n' 0 0 > "$folder/docs/page.md"
expect "a row and an output as long as they are" 0 "all 1 checks are clean" lint columns
printf '%0121d\n' 0 >> "$folder/docs/page.md"
expect "a sentence of 121 columns" 1 "docs/page.md:4:" lint columns
[ "$failures" = 0 ]
