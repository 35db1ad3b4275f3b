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


def said(test, name):
    """The list that a test's property is; empty without it."""
    return next((kept["value"] for kept in test["properties"] if kept["name"] == name), [])


def is_long(test):
    return any(label.startswith("long-") for label in said(test, "LABELS"))


def is_case(test):
    """A case of a test program: its command has a filter of GoogleTest."""
    return any(word.startswith("--gtest_filter=") for word in test.get("command", []))


def chosen(listed, name):
    """Numbers of the tests that `name` stands for, as ctest counts."""
    numbered = list(enumerate(listed, 1))
    cases = [number for number, test in numbered if is_case(test) and program(test) == name and not is_long(test)]
    patterns = (name, f"{name}.*", f"{name}/*", f"*/{name}.*", f"proof_{name}")
    return cases or [
        number
        for number, test in numbered
        if any(fnmatch.fnmatchcase(test["name"], pattern) for pattern in patterns)
    ]


def with_fixtures(listed, numbers):
    """The tests of these numbers, and those that ctest runs before them."""
    found, waiting = [], [listed[number - 1] for number in numbers]
    while waiting:
        test = waiting.pop()
        found.append(test)
        asked = set(said(test, "FIXTURES_REQUIRED"))
        waiting += [t for t in listed if asked & set(said(t, "FIXTURES_SETUP")) and t not in found + waiting]
    return found


def targets(build, run):
    """What is built for these tests: the programs that their commands name, and the one that scripts expect; nothing,
    which is all, where one looks into the whole folder or at what benches are made of. Some build their own.
    """
    build = os.path.abspath(build)
    others = [test for test in run if program(test) != "built_test.sh"]
    words = {word.split("=")[-1] for test in others for word in test.get("command", [])}
    inside = {os.path.relpath(word, build) for word in words if word == build or word.startswith(build + os.sep)}
    if any(place == "." or place.startswith("tb" + os.sep) for place in inside):
        return []
    return sorted({"raypool", *(place for place in inside if place.startswith("raypool"))})


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
        wanted = [name]
    elif chosen(listed, name):
        wanted = targets(build, with_fixtures(listed, chosen(listed, name)))
    else:
        # Of a suite nothing is known before its program is there.
        wanted = [] if name[:1].isupper() else None
    if wanted is not None:
        subprocess.run([BUILD_SCRIPT, build, *wanted], check=True)
        # Programs that are there now have other tests, and so all have other numbers.
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
