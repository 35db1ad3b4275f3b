#!/usr/bin/python3
"""What others read of the project before they read its code: one version number, the citation, issue forms, workflows,
the Dockerfile, presets, hooks and what editors read name only what there is, and agree with each other."""
import configparser
import json
import pathlib
import re
import subprocess
import unittest

import yaml

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
FOLDERS = ("cmake", "cpp_model", "sim", "studies", "program", "tb")
CMAKE_FILES = [path for folder in FOLDERS for path in (ROOT / folder).rglob("*")
               if path.name == "CMakeLists.txt" or path.suffix == ".cmake"]  # fmt: skip
CMAKE = "".join(path.read_text() for path in [ROOT / "CMakeLists.txt", *CMAKE_FILES])
VERSION = re.search(r"^project\(raypool VERSION ([0-9.]+)", CMAKE, re.M)[1]
MAKEFILE = (ROOT / "Makefile").read_text() + (ROOT / "studies/studies.mk").read_text()
TARGETS = set(re.findall(r"^([a-z-]+):", MAKEFILE, re.M))
GROUPS = set(re.findall(r"^([a-z-]+) +\S", (ROOT / "scripts/packages.txt").read_text(), re.M))
WORKFLOWS = sorted((ROOT / ".github/workflows").glob("*.yml"))
ACTIONS = {"actions/checkout", "actions/cache", "actions/upload-artifact"}


def text(name):
    return (ROOT / name).read_text()


def data(name):
    return yaml.safe_load(text(name))


class Version(unittest.TestCase):
    """CMake gives it to the program, its reports, packages and the installed configuration; scripts/core.py to
    raypool.core. Here are those that are written by hand."""

    def test_the_citation_has_it(self):
        self.assertEqual(str(data("CITATION.cff")["version"]), VERSION)

    def test_the_newest_release_of_the_changelog_has_it(self):
        self.assertEqual(re.search(r"^## (\d.*)$", text("CHANGELOG.md"), re.M)[1].split()[0], VERSION)

    def test_users_ask_cmake_for_it(self):
        minor = VERSION.rpartition(".")[0]
        for name in ("examples/own-chip/CMakeLists.txt", "docs/use/package.md"):
            self.assertEqual(re.findall(r"^find_package\(raypool ([0-9.]+)", text(name), re.M), [minor], name)


class Citation(unittest.TestCase):
    def test_it_cites_the_project_and_the_thesis(self):
        citation = data("CITATION.cff")
        for key in ("cff-version", "message", "title", "authors"):
            self.assertTrue(citation[key], key)
        self.assertEqual(citation["license"], "Apache-2.0")
        for reference in citation["references"]:
            self.assertEqual({"type", "title", "authors"} - set(reference), set())
            self.assertIn(f'"{reference["title"]}"', re.sub(r"\s+", " ", text("README.md")))


class IssueForms(unittest.TestCase):
    def test_each_asks_questions_that_differ(self):
        forms = [path for path in (ROOT / ".github/ISSUE_TEMPLATE").glob("*.yml") if path.name != "config.yml"]
        self.assertEqual(sorted(path.stem for path in forms), ["bug", "feature", "question"])
        for path in forms:
            form = data(path)
            self.assertEqual({"name", "description", "body"} - set(form), set(), path)
            ids = [part["id"] for part in form["body"]]
            self.assertEqual(len(ids), len(set(ids)), path)
            for part in form["body"]:
                self.assertIn(part["type"], ("textarea", "input", "dropdown", "checkboxes"), path)
                self.assertTrue(part["attributes"]["label"], path)
            self.assertTrue(any(part.get("validations", {}).get("required") for part in form["body"]), path)


class Workflows(unittest.TestCase):
    def setUp(self):
        self.workflows = [data(path) for path in WORKFLOWS]
        self.assertGreater(len(self.workflows), 1)
        self.jobs = [job for workflow in self.workflows for job in workflow["jobs"].values()]
        self.steps = [step for job in self.jobs for step in job["steps"]]

    def test_they_run_in_a_bare_debian(self):
        for job in self.jobs:
            self.assertEqual(job["container"], "debian:12")
            self.assertIn("timeout-minutes", job)
        for workflow in self.workflows:
            self.assertEqual(workflow["permissions"], {"contents": "read"})

    def test_they_call_targets_of_make(self):
        called = [name for step in self.steps for name in re.findall(r"\bmake ([a-z][a-z-]*)", step.get("run", ""))]
        self.assertEqual([name for name in called if name not in TARGETS], [])
        self.assertEqual({"test", "lint", "test-long", "docs"} - set(called), set())

    def test_they_use_three_actions_and_their_own(self):
        used = [step["uses"] for step in self.steps if "uses" in step]
        for own in {name for name in used if name.startswith("./")}:
            action = data(f"{own}/action.yml")
            self.assertEqual(action["runs"]["using"], "composite")
            used += [step["uses"] for step in action["runs"]["steps"] if "uses" in step]
            for step in (step for step in self.steps if step.get("uses") == own):
                self.assertEqual(set(step["with"]), set(action["inputs"]))
        others = {name.split("@")[0] for name in used if not name.startswith("./")}
        self.assertEqual(others, ACTIONS)

    def test_every_share_of_the_long_tests_has_its_job(self):
        shares = int(re.search(r"set\(RAYPOOL_SHARES (\d+)\)", CMAKE)[1])
        matrices = [job["strategy"]["matrix"]["share"] for job in self.jobs if "strategy" in job]
        self.assertEqual(matrices, [list(range(1, shares + 1))])


class Image(unittest.TestCase):
    def setUp(self):
        self.dockerfile = text("Dockerfile")
        self.groups = set(re.search(r'^ARG groups="(.*)"$', self.dockerfile, re.M)[1].split())

    def test_it_has_the_groups_that_targets_set_up(self):
        self.assertEqual(self.groups - GROUPS, set())
        wanted = set(re.findall(r"setup-([a-z]+)", MAKEFILE))
        self.assertEqual(wanted - self.groups, {"slurm", "models"})

    def test_it_is_given_the_files_that_it_copies_and_no_others(self):
        copied = re.search(r"^COPY (.*) \S+$", self.dockerfile, re.M)[1].split()
        given = [line[1:] for line in text(".dockerignore").splitlines() if line.startswith("!")]
        self.assertEqual(copied, given)
        for name in copied:
            self.assertTrue((ROOT / name).exists(), name)

    def test_it_does_not_work_as_root(self):
        self.assertEqual(re.findall(r"^USER (.*)$", self.dockerfile, re.M), ["raypool"])


class Presets(unittest.TestCase):
    def setUp(self):
        self.presets = json.loads(text("CMakePresets.json"))

    def test_cmake_reads_them(self):
        done = subprocess.run(["cmake", "--list-presets=all"], cwd=ROOT, capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_each_can_be_configured_built_and_tested(self):
        kinds = [[preset["name"] for preset in self.presets[f"{kind}Presets"]]
                 for kind in ("configure", "build", "test")]  # fmt: skip
        self.assertEqual(kinds, [kinds[0]] * 3)
        self.assertIn("default", kinds[0])

    def test_they_set_what_the_project_declares(self):
        declared = set(re.findall(r"^ *option\((\w+)|^ *set\((\w+) .* CACHE ", CMAKE, re.M))
        declared = {name for names in declared for name in names} | {"CMAKE_BUILD_TYPE"}
        for preset in self.presets["configurePresets"]:
            self.assertEqual(set(preset["cacheVariables"]) - declared, set(), preset["name"])

    def test_the_default_is_what_make_configures(self):
        default = self.presets["configurePresets"][0]
        folder = re.search(r"^export BUILD \?= (.*)$", MAKEFILE, re.M)[1]
        self.assertEqual(default["binaryDir"], "${sourceDir}/" + folder)
        configure = text("scripts/configure.sh")
        self.assertIn(f"-G {default['generator']} -DCMAKE_BUILD_TYPE={default['cacheVariables']['CMAKE_BUILD_TYPE']} ",
                      configure)  # fmt: skip

    def test_the_pages_name_each(self):
        page = text("docs/develop/development.md")
        self.assertEqual([preset["name"] for preset in self.presets["configurePresets"]
                          if f"`{preset['name']}`" not in page], [])  # fmt: skip


class Hooks(unittest.TestCase):
    def test_they_are_the_projects_own(self):
        (repository,) = data(".pre-commit-config.yaml")["repos"]
        self.assertEqual(repository["repo"], "local")
        tools = {"clang-format", "flake8", "shellcheck"}
        for hook in repository["hooks"]:
            self.assertEqual(hook["language"], "system")
            program = hook["entry"].split()[0]
            self.assertTrue(program in tools or (ROOT / program).stat().st_mode & 0o100, program)


class Editors(unittest.TestCase):
    def setUp(self):
        self.sections = configparser.ConfigParser()
        self.sections.read_string("[root]\n" + text(".editorconfig"))

    def test_lines_are_as_long_as_the_checks_allow(self):
        columns = self.sections["*"]["max_line_length"]
        self.assertEqual(re.search(r"^ColumnLimit: (\d+)$", text(".clang-format"), re.M)[1], columns)
        self.assertEqual(re.search(r"^max-line-length = (\d+)$", text(".flake8"), re.M)[1], columns)

    def test_sources_end_lines_as_editors_do(self):
        names = []
        for kind in ("text", "pages"):
            listed = subprocess.run([ROOT / "scripts/sources.sh", kind], capture_output=True, text=True, check=True)
            names += listed.stdout.split()
        self.assertGreater(len(names), 500)
        for name in names:
            content = (ROOT / name).read_bytes()
            self.assertNotIn(b"\r", content, name)
            self.assertIsNone(re.search(rb"[ \t]+$", content, re.M), name)
            self.assertTrue(not content or content.endswith(b"\n"), name)
            if not re.search(r"(^|/)Makefile$|\.mk$", name):
                self.assertNotIn(b"\t", content, name)


if __name__ == "__main__":
    unittest.main()
