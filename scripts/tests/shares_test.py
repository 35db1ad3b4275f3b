#!/usr/bin/env python3
"""Nothing falls between the shares: shares_test.py BUILD. Each long test is in one of ten shares and `make test` runs
all others, among them every case of every test program; the parts of clang-tidy make up all sources; what has changed
is read, headers through a source that includes them."""
import collections
import fnmatch
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
import tidy  # noqa: E402

BUILD = sys.argv.pop() if len(sys.argv) > 1 else "build"


# Suites of a test program that make numerics-long runs, which are no tests.
HOURS = "*Long.*:*Long/*:*Hours.*"


def cases(program):
    """The names of all tests of a program of GoogleTest."""
    listed = subprocess.run([program, "--gtest_list_tests", f"--gtest_filter=-{HOURS}"], check=True,
                            capture_output=True, text=True)  # fmt: skip
    found, suite = [], ""
    for line in listed.stdout.splitlines():
        name = line.split("#")[0].rstrip()
        if line.startswith("  "):
            found.append(suite + name.strip())
        elif name.endswith("."):
            suite = name
    return found


def said(test, name):
    """The list that a test's property is; empty without it."""
    return next((each["value"] for each in test.get("properties", []) if each["name"] == name), [])


class Shares(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        listed = subprocess.run(["ctest", "--test-dir", BUILD, "--show-only=json-v1"], check=True, capture_output=True,
                                text=True)
        cls.tests = json.loads(listed.stdout)["tests"]
        # [program] = the filters of the tests that run it.
        cls.programs = collections.defaultdict(list)
        for test in cls.tests:
            program, *words = test.get("command", [""])
            cls.programs[program] += [word.removeprefix("--gtest_filter=") for word in words[:1]
                                      if word.startswith("--gtest_filter=")]  # fmt: skip

    def test_each_test_is_in_make_test_or_in_one_share_and_no_share_is_empty(self):
        shares = set()
        for test in self.tests:
            labels = said(test, "LABELS")
            self.assertLessEqual(len(labels), 1, test["name"])
            shares.update(labels)
        self.assertEqual(shares, {f"long-{k}" for k in range(1, 11)})

    def test_no_test_of_make_test_needs_what_a_long_one_sets_up(self):
        long = {fixture for test in self.tests if said(test, "LABELS") for fixture in said(test, "FIXTURES_SETUP")}
        self.assertTrue(long)
        for test in self.tests:
            if not said(test, "LABELS"):
                self.assertEqual(long.intersection(said(test, "FIXTURES_REQUIRED")), set(), test["name"])

    def test_each_case_of_a_test_program_is_a_test_once(self):
        self.assertEqual([test["name"] for test in self.tests if test["name"].endswith("_NOT_BUILT")], [])
        programs = {program: found for program, found in self.programs.items() if found}
        self.assertGreater(len(programs), 40)
        for program, found in programs.items():
            self.assertEqual(sorted(found), sorted(cases(program)), program)

    def test_each_filter_of_long_cases_still_has_some(self):
        by_name = {pathlib.Path(program).name: found for program, found in self.programs.items()}
        lines = pathlib.Path(BUILD, "long_cases.txt").read_text().splitlines()
        self.assertGreater(len(lines), 10)
        for line in lines:
            program, pattern = line.split()
            self.assertTrue(fnmatch.filter(by_name[program], pattern), line)

    def test_the_parts_of_the_sources_are_all_of_them_once(self):
        sources = {pathlib.Path(f"/{n}.cpp") for n in range(57)}
        parts = [tidy.share_of(sources, f"{k}/10") for k in range(1, 11)]
        self.assertEqual(set.union(*parts), sources)
        self.assertEqual(sum(len(part) for part in parts), 57)
        for wrong in "0/10", "11/10", "3", "a/b":
            with self.assertRaises(SystemExit) as refusal:
                tidy.share_of(sources, wrong)
            self.assertIn("--share is", str(refusal.exception))


class Changed(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root, self.before = pathlib.Path(folder.name), tidy.ROOT
        tidy.ROOT = self.root
        self.addCleanup(lambda: setattr(tidy, "ROOT", self.before))
        self.write("sim/user.cpp", '#include "model/deep.hpp"\n')
        self.write("model/deep.hpp", '#include "model/base.hpp"\n')
        self.write("model/base.hpp", "\n")
        self.write("model/own.hpp", "\n")
        self.write("model/own.cpp", '#include "model/own.hpp"\n')
        self.write("model/other.cpp", "\n")
        self.git("init", "-q")
        self.git("add", ".")
        self.git("-c", "user.name=x", "-c", "user.email=x@localhost", "commit", "-q", "-m", "first")

    def write(self, name, text):
        (self.root / name).parent.mkdir(exist_ok=True)
        (self.root / name).write_text(text)

    def git(self, *arguments):
        subprocess.run(["git", *arguments], cwd=self.root, check=True)

    def changed(self):
        return {str(path.relative_to(self.root)) for path in tidy.changed_sources("HEAD")}

    def test_nothing_is_read_when_nothing_has_changed(self):
        self.assertEqual(self.changed(), set())

    def test_a_header_is_read_with_its_source(self):
        self.write("model/own.hpp", "// changed\n")
        self.assertEqual(self.changed(), {"model/own.cpp"})

    def test_a_header_that_only_headers_include_is_read_through_them(self):
        self.write("model/base.hpp", "// changed\n")
        self.assertEqual(self.changed(), {"sim/user.cpp"})

    def test_sources_that_no_commit_has_yet_are_read(self):
        self.write("model/new.cpp", "\n")
        self.assertEqual(self.changed(), {"model/new.cpp"})

    def test_a_commit_that_there_is_not_is_named(self):
        with self.assertRaises(SystemExit) as refusal:
            tidy.changed_sources("nowhere")
        self.assertIn("nowhere", str(refusal.exception))


if __name__ == "__main__":
    unittest.main()
