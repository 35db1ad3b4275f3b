#!/usr/bin/env python3
"""make test ONLY=NAME runs what NAME stands for and never passes without a test: one_test_test.py BUILD. Each test that
docs/develop/where.md names is one."""
import contextlib
import io
import pathlib
import re
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(ROOT / "scripts"))
import one_test  # noqa: E402

BUILD = sys.argv.pop() if len(sys.argv) > 1 else "build"
# What else stands between backquotes in the last column of where.md: commands, options, files.
NO_TEST = re.compile(r"[ =.]|^raypool$")

TESTS = """
add_test(Sums.Add "/bin/true" "--gtest_filter=Sums.Add")
add_test(Sums.Large "/bin/false" "--gtest_filter=Sums.Large")
set_tests_properties(Sums.Large PROPERTIES LABELS "long-2")
add_test(All/Products.Multiply/3 "/bin/true" "--gtest_filter=All/Products.Multiply/3")
add_test(page_a "/bin/echo")
add_test(page_b "/bin/false")
add_test(page_c "/bin/echo" "@/raypool_faults" "@/out")
set_tests_properties(page_c PROPERTIES FIXTURES_REQUIRED unit)
add_test(page_d "/bin/echo" "@")
add_test(page_e "@/built_test.sh" "@" "own")
add_test(unit "/bin/echo" "PROGRAM=@/raypool-tables")
set_tests_properties(unit PROPERTIES FIXTURES_SETUP unit)
add_test(proof_queue "/bin/echo")
add_test(pool_test_NOT_BUILT pool_test_NOT_BUILT)
"""


class Chosen(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.build = folder.name
        pathlib.Path(self.build, "CTestTestfile.cmake").write_text(TESTS.replace("@", self.build))
        log = pathlib.Path(self.build, "built")
        script = pathlib.Path(self.build, "build.sh")
        script.write_text(f'#!/bin/sh\nshift\necho "$@." >> {log}\n')
        script.chmod(0o755)
        pathlib.Path(self.build, "built_test.sh").symlink_to("/bin/true")
        self.addCleanup(setattr, one_test, "BUILD_SCRIPT", one_test.BUILD_SCRIPT)
        one_test.BUILD_SCRIPT = script
        self.built = lambda: log.read_text().splitlines() if log.exists() else []

    def names(self, name):
        listed = one_test.tests(self.build)
        return [listed[number - 1]["name"] for number in one_test.chosen(listed, name)]

    def test_a_program_is_its_cases_without_the_long_ones(self):
        self.assertEqual(self.names("true"), ["Sums.Add", "All/Products.Multiply/3"])
        self.assertEqual(self.names("false"), [])

    def test_a_name_is_a_test_a_suite_a_pattern_or_a_proof(self):
        self.assertEqual(self.names("page_a"), ["page_a"])
        self.assertEqual(self.names("page_*"), ["page_a", "page_b", "page_c", "page_d", "page_e"])
        self.assertEqual(self.names("Sums"), ["Sums.Add", "Sums.Large"])
        self.assertEqual(self.names("Products"), ["All/Products.Multiply/3"])
        self.assertEqual(self.names("queue"), ["proof_queue"])
        self.assertEqual(self.names("page"), [])

    def test_only_what_is_named_runs_and_a_failure_is_one(self):
        for name, passes in (("page_a", True), ("page_b", False), ("true", True)):
            self.assertEqual(one_test.main(self.build, name) == 0, passes, name)

    def test_only_what_runs_is_built(self):
        for name in ("true", "page_a", "page_c", "page_d", "page_e"):
            one_test.main(self.build, name)
        self.assertEqual(self.built(), ["true.", "raypool.", "raypool raypool-tables raypool_faults.", ".",
                                        "raypool."])  # fmt: skip

    def test_a_name_of_nothing_is_refused_and_nothing_is_built_for_it(self):
        for name, near in (("pool_tset", "pool_test"), ("page_f", "page_"), ("nothing", "")):
            said = io.StringIO()
            with contextlib.redirect_stderr(said):
                self.assertEqual(one_test.main(self.build, name), 1)
            self.assertIn(f"make test: ONLY={name}: no test", said.getvalue())
            self.assertIn(f"did you mean {near}" if near else "has this name\n", said.getvalue())
        self.assertEqual(self.built(), [])


class Map(unittest.TestCase):
    def test_each_test_that_where_md_names_is_one(self):
        listed = one_test.tests(BUILD)
        known = one_test.programs(listed)
        rows = [line for line in (ROOT / "docs/develop/where.md").read_text().splitlines() if line.count(" | ") == 2]
        named = {name for row in rows for name in re.findall(r"`([^`]+)`", row.rsplit(" | ", 1)[1])}
        named = {name for name in named if not NO_TEST.search(name)}
        self.assertGreater(len(named), 60)
        self.assertEqual([n for n in sorted(named) if n not in known and not one_test.chosen(listed, n)], [])


if __name__ == "__main__":
    unittest.main()
