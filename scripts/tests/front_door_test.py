#!/usr/bin/env python3
"""What somebody new reads first: the README is one screen, `make help` too, and nothing that they name is missing."""
import pathlib
import re
import subprocess
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
MAKEFILE = (ROOT / "Makefile").read_text()
README = (ROOT / "README.md").read_text()


def printed(target):
    command = ["make", "--no-print-directory", "-C", str(ROOT), target]
    environment = {"PATH": "/usr/local/bin:/usr/bin:/bin"}
    return subprocess.run(command, capture_output=True, text=True, check=True, env=environment).stdout.splitlines()


def section(title):
    return re.search(rf"^## {title}\n(.*?)(?=^## |\Z)", README, re.M | re.S)[1]


def named_targets(lines):
    return [match[1] for match in (re.match(r"  make ([a-z-]+) +\S", line) for line in lines) if match]


class Help(unittest.TestCase):
    def setUp(self):
        self.described = re.findall(r"^([a-z-]+):.*## ", MAKEFILE, re.M)

    def test_help_prints_fifteen_lines(self):
        lines = printed("help")
        self.assertLessEqual(len(lines), 15)
        self.assertEqual([line for line in lines if len(line) > 120], [])
        self.assertEqual([name for name in named_targets(lines) if name not in self.described], [])
        for name in ("sim", "test", "synth", "help-all"):
            self.assertIn(name, " ".join(lines))

    def test_help_all_lists_every_target_that_is_described(self):
        self.assertEqual(named_targets(printed("help-all")), self.described)

    def test_help_all_tells_every_variable_that_has_a_default(self):
        text = "\n".join(printed("help-all"))
        variables = re.findall(r"^([A-Z_]+) +\?=", MAKEFILE, re.M)
        self.assertGreater(len(variables), 40)
        # A and B stand in the line of `make compare`.
        self.assertEqual([name for name in variables if not re.search(rf"\b{name}\b", text)], [])


class Readme(unittest.TestCase):
    def test_it_is_one_screen(self):
        self.assertLessEqual(len(README.splitlines()), 60)

    def test_each_of_four_figures_has_the_command_that_prints_it(self):
        items = re.split(r"^- ", section("Four figures"), flags=re.M)[1:]
        self.assertEqual(len(items), 4)
        for item in items:
            self.assertRegex(item, r"^\*\*.*\d.*\*\*")
            self.assertRegex(item, r"`make [^`]*`")

    def test_it_has_two_commands_and_six_links(self):
        commands = re.search(r"^```sh\n(.*?)^```", section("Two commands"), re.M | re.S)[1]
        self.assertEqual([line.split("#")[0].strip() for line in commands.splitlines()], ["make sim", "make test"])
        self.assertEqual(len(re.findall(r"^- ", section("Six links"), re.M)), 6)

    def test_variables_in_its_commands_are_variables_of_make(self):
        known = set(re.findall(r"^([A-Z_]+) +\?=", MAKEFILE, re.M))
        commands = re.findall(r"`make ([^`]*)`", README)
        used = {name for command in commands for name in re.findall(r"\b([A-Z_]+)=", command)}
        self.assertGreater(len(used), 5)
        self.assertEqual(used - known, set())


if __name__ == "__main__":
    unittest.main()
