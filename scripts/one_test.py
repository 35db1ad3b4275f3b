#!/usr/bin/env python3
"""Builds and runs what docs/develop/where.md names: scripts/one_test.py BUILD NAME; NAME is a test program, whose long
cases are left to make test-long, or a test of ctest, a suite of them, a pattern or a proof (FunctionalCore, report_*).

Ends with 1 if one fails or there is none, as ctest -R does not: a name that is misspelt must not pass.
"""
import difflib
import fnmatch
import json
import os
import pathlib
import subprocess
import sys

BUILD_SCRIPT = pathlib.Path(__file__).resolve().parent / "build.sh"
# CTest's name for the cases of a program that is not built yet.
NOT_BUILT = "_NOT_BUILT"


def tests(build):
    """What ctest knows, in its order: of a program that is not built one test, without a command."""
    listed = ["ctest", "--test-dir", build, "--show-only=json-v1"]
    return json.loads(subprocess.run(listed, capture_output=True, text=True, check=True).stdout)["tests"]


def program(test):
    """The name of the program that a test runs."""
    return os.path.basename(test["command"][0]) if "command" in test else test["name"].removesuffix(NOT_BUILT)


def is_long(test):
    labels = [word for kept in test["properties"] if kept["name"] == "LABELS" for word in kept["value"]]
    return any(label.startswith("long-") for label in labels)


def is_case(test):
    """A case of a test program: its command has a filter of GoogleTest."""
    return any(word.startswith("--gtest_filter=") for word in test.get("command", []))


def chosen(listed, name):
    """Numbers of the tests that `name` stands for, as ctest counts."""
    numbered = list(enumerate(listed, 1))
    cases = [number for number, test in numbered if is_case(test) and program(test) == name and not is_long(test)]
    patterns = (name, f"{name}.*", f"{name}/*", f"proof_{name}")
    return cases or [
        number
        for number, test in numbered
        if any(fnmatch.fnmatchcase(test["name"], pattern) for pattern in patterns)
    ]


def programs(listed):
    return {program(test) for test in listed if is_case(test) or test["name"].endswith(NOT_BUILT)}


def refused(listed, name):
    """The sentence for a name of nothing. CTest knows a suite when its program is built, so most have to be."""
    suites = {test["name"].split(".")[0] for test in listed if is_case(test)}
    known = sorted(programs(listed) | suites | {t["name"] for t in listed if "command" in t and not is_case(t)})
    near = difflib.get_close_matches(name, known, 1)
    question = f": did you mean {near[0]}?" if near else ""
    return f"make test: ONLY={name}: no test and no test program has this name{question}"


def main(build, name):
    listed = tests(build)
    if name in programs(listed):
        subprocess.run([BUILD_SCRIPT, build, name], check=True)
        listed = tests(build)
    elif chosen(listed, name) or name[:1].isupper():
        subprocess.run([BUILD_SCRIPT, build], check=True)
        listed = tests(build)
    numbers = chosen(listed, name)
    if not numbers:
        print(refused(listed, name), file=sys.stderr)
        return 1
    # From, to, stride, then numbers of their own: none from the range.
    only = ",".join(["0", "0", "0", *map(str, numbers)])
    run = ["ctest", "--test-dir", build, "--output-on-failure", "-j", str(os.cpu_count() or 2), "-I", only]
    return subprocess.run(run, check=False).returncode


if __name__ == "__main__":
    try:
        sys.exit(main(*sys.argv[1:]))
    except subprocess.CalledProcessError as error:
        sys.exit(error.returncode)
