#!/usr/bin/env python3
"""What a newcomer reads first: the README is one screen, `make help` too, and nothing that they name is missing."""
import pathlib
import re
import shutil
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
STUDIES = "studies/studies.mk"
MAKEFILE = (ROOT / "Makefile").read_text() + (ROOT / STUDIES).read_text()
README = (ROOT / "README.md").read_text()
VALUES = (ROOT / "scripts/check_values.sh").read_text()
WITH_CONFIG = re.search(r"^WITH_FRAME := (.*)\nWITH_CONFIG := (.*)", MAKEFILE, re.M).expand(r"\1 \2").split()
DEFAULTS = re.findall(r"^(?:export )?([A-Z_]+) \?=", MAKEFILE, re.M)


def make(*words, folder=ROOT, **environment):
    command = ["make", "--no-print-directory", "-C", str(folder), *words]
    environment = {"PATH": "/usr/local/bin:/usr/bin:/bin", **environment}
    return subprocess.run(command, capture_output=True, text=True, check=False, env=environment)


def printed(*words):
    done = make(*words)
    assert done.returncode == 0, done.stderr
    return done.stdout.splitlines()


def variables():
    """What help-all lists, in sections: targets of make, and a variable of theirs."""
    targets = []
    for line in printed("help-all"):
        head = re.match(r"(?:variables? )?of (make|every target)([a-z, -]*)", line)
        if head:
            targets = re.findall(r"[a-z-]+", head[2].replace(" and ", ", ").split(", with")[0]) or ["sim"]
        if targets:
            yield from ((targets, name) for name in re.findall(r"  ([A-Z_]+)=", line))


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

    def test_help_all_lists_studies_apart(self):
        lines = printed("help-all")
        studies = lines[lines.index("studies of the machine") :]
        self.assertEqual(named_targets(studies), re.findall(r"^([a-z-]+):.*## ", (ROOT / STUDIES).read_text(), re.M))
        self.assertIn("fit", named_targets(studies))

    def test_help_all_lists_every_variable_that_has_a_default(self):
        listed = {name for _, name in variables()}
        self.assertGreater(len(listed), 50)
        self.assertEqual(set(DEFAULTS) - listed, set())
        text = "\n".join(printed("help-all"))
        for name, default in re.findall(r"^export ([A-Z_]+) \?= ([^$\n]+)$", MAKEFILE, re.M):
            self.assertRegex(text, rf"(?m)^  {name}=.*\n?.* {default}$")

    def test_few_variables_have_a_default_that_is_not_the_programs(self):
        self.assertGreater(len(DEFAULTS), 10)
        self.assertLessEqual(MAKEFILE.count("?="), 30)

    def test_every_variable_that_help_all_lists_reaches_its_targets(self):
        lost = []
        for targets, name in variables():
            if name == "SCENES":  # the programs themselves read it
                continue
            for target in targets:
                words = ["-n", target, *(["ENGINE=sampled"] if name == "SEED" else [])]
                recipe = printed(*words)
                if not re.search(rf"\$\{{?{name}\b", "\n".join(recipe)) and printed(*words, name + "=1") == recipe:
                    lost.append(f"make {target} {name}=")
        self.assertEqual(lost, [])


class Values(unittest.TestCase):
    """A copy of the Makefile with a program that prints its words."""

    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, self.folder)
        (self.folder / "studies").mkdir()
        for name in ("Makefile", STUDIES):
            shutil.copy(ROOT / name, self.folder / name)
        for name in ("setup.sh", "configure.sh", "build.sh", "unit.sh", "check_values.sh", "raypool"):
            path = self.folder / ("build" if name == "raypool" else "scripts") / name
            path.parent.mkdir(exist_ok=True)
            path.write_text("#!/bin/bash\n" + "printf '%s\\n' \"$@\"\n" * (name == "raypool"))
            path.chmod(0o755)

    def words(self, *words, **environment):
        done = make(*words, folder=self.folder, **environment)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout.splitlines()

    def test_each_is_one_word(self):
        room = "it's \"my\" room.obj"
        said = self.words("sim", "SCENE=" + room, "EYE=-1,2,3", "SET=warps=2 lanes=4", "ARGS=--cycles 9 'a b'",
                          OUT="-o p", CUS="2")  # fmt: skip
        for word in ("--scene=" + room, "--eye=-1,2,3", "--set=warps=2 lanes=4", "--units=2", "--out=-o p", "9", "a b"):
            self.assertIn(word, said)
        self.assertEqual(self.words("compare", "A=-a b", "B=" + room), ["compare", "-a b", room])

    def test_defaults_reach_the_program_and_an_environment_overrules_them(self):
        listed = re.findall(r"^export (SCENE|SIZE|DEPTH|CONFIG|ENGINE) \?= (\S+)$", MAKEFILE, re.M)
        self.assertEqual(len(listed), 5)
        said, other = self.words("sim"), self.words("sim", **{name: "else" for name, _ in listed})
        for name, default in listed:
            self.assertIn(f"--{name.lower()}={default}", said)
            self.assertIn(f"--{name.lower()}=else", other)

    def test_what_may_be_afforded_leaves_the_engine_to_the_program(self):
        for word in ("WITHIN=9s", "ERROR=1%"):
            said = self.words("sim", word)
            self.assertIn(f"--{word.lower()}", said)
            self.assertEqual([option for option in said if option.startswith("--engine")], [])
            self.assertIn("--engine=sampled", self.words("sim", word, "ENGINE=sampled"))

    def test_what_is_empty_is_left_to_the_program(self):
        said = self.words("sim", "SCENE=", "TRAVERSER=")
        self.assertEqual([word for word in said if re.match("--(scene|traverser|set|view|seed)", word)], [])

    def test_an_unknown_one_is_refused_with_the_nearest(self):
        for word, name in (("SCNE=room", "SCENE"), ("look-at=1", "LOOK_AT"), ("CONFIGS=4w4c", "CONFIG")):
            done = make("sim", "SIZE=8x8", word, folder=self.folder)
            self.assertEqual((done.returncode, done.stdout), (2, ""))
            said = f"{word.split('=')[0]} is not a variable of this Makefile: did you mean {name}? (make help-all"
            self.assertIn(said, done.stderr)
            self.assertEqual(done.stderr.count("\n"), 1)
        self.assertIn("XYZZY is not a variable of this Makefile (make", make("XYZZY=1", folder=self.folder).stderr)
        # Neither parts of a value, nor what an outer make hands on, nor what tools read.
        self.words("sim", "SET=warps=2 scne=3", "CXX=g++", "CMAKE_GENERATOR=Ninja")
        self.words("sim", "SCNE=room", MAKELEVEL="1")

    def test_an_unknown_target_is_refused_with_the_nearest(self):
        for word, name in (("sims", "sim"), ("symth", "synth"), ("help-al", "help-all")):
            done = make(word, folder=self.folder)
            self.assertEqual((done.returncode, done.stdout), (2, ""))
            self.assertIn(f"there is no target {word}: did you mean {name}? (make help-all", done.stderr)
        self.assertIn("there is no target xyzzy (make", make("xyzzy", folder=self.folder).stderr)

    def test_units_are_refused_where_one_is_synthesised(self):
        done = make("synth", "CUS=2", folder=self.folder)
        self.assertEqual(done.returncode, 2)
        self.assertIn("CUS is for whole chips: make synth CHIP=1 CUS=2, or leave it out", done.stderr)


class Frames(unittest.TestCase):
    """What make sim, and others that are given a configuration, refuse before they build."""

    def checked(self, *names, target="sim", **variables):
        done = subprocess.run([ROOT / "scripts" / "check_values.sh", target, *names], capture_output=True, text=True,
                              check=False, env={"PATH": "/usr/local/bin:/usr/bin:/bin", **variables})  # fmt: skip
        self.assertEqual(done.stdout, "")
        self.assertEqual(done.returncode, 1 if done.stderr else 0)
        self.assertLessEqual(done.stderr.count("\n"), 1)
        return done.stderr

    def test_what_can_be_drawn_passes(self):
        self.assertEqual(self.checked(), "")
        defaults = dict(re.findall(r"^export ([A-Z]+) \?= (\S+)$", MAKEFILE, re.M))
        self.assertEqual(self.checked(**defaults), "")
        for engine in re.search(r"ENGINE=(\S+)", MAKEFILE)[1].split("|"):
            self.assertEqual(self.checked(ENGINE=engine), "")
        for name, values in (("SCENE", ("cornell", "tour", "tour.obj", "examples/tour.obj")), ("CUS", ("1", "2", "4")),
                             ("CONFIG", ("best", "best_4w4c", "32w1c", "configs/8w8c.json")), ("DEPTH", ("1", "254")),
                             ("EYE", ("-1,2.5,+3e4", "0,0,0")), ("SIZE", ("1x1", "16384x16384")),
                             ("VIEW", ("configs/views/conference.json",)), ("DETAIL", ("0.25",))):  # fmt: skip
            for value in values:
                self.assertEqual(self.checked(**{name: value}), "", f"{name}={value}")

    def test_what_cannot_is_one_sentence_with_the_nearest(self):
        for name, value, words in (
            ("ENGINE", "lockstp", "did you mean lockstep?"), ("CUS", "3", "none of: 1 2 4"),
            ("SIZE", "8", "256x256"), ("SIZE", "0x8", "1 to 16384"), ("SIZE", "8x20000", "1 to 16384"),
            ("DEPTH", "0", "from 1 to 254"), ("DEPTH", "255", "from 1 to 254"), ("DEPTH", "two", "from 1 to 254"),
            ("THREADS", "0", "from 1 to 256"), ("DETAIL", "fine", "a number"), ("FOV", "wide", "a number"),
            ("EYE", "1,2", "three numbers"), ("UP", "0,1,z", "three numbers"),
            ("VIEW", "configs/views/confrence.json", "did you mean configs/views/conference.json?"),
            ("CONFIG", "8w8d", "did you mean 8w8c?"),
            ("CONFIG", "configs/8w8.json", "mean configs/8w8c.json?"), ("CONFIG", "bset_8w8c", "mean best_8w8c?"),
            ("CONFIG", "2w2c_small", "did you mean configs/cosim/2w2c_small.json?"),
            ("SCENE", "rom", "did you mean room?"), ("SCENE", "tuor", "did you mean examples/tour.obj?"),
            ("SCENE", "examples/tuor.obj", "did you mean examples/tour.obj?"), ("SCENE", "none.glb", "no such scene"),
        ):  # fmt: skip
            said = self.checked(**{name: value})
            self.assertTrue(said.startswith(f"make sim: {name}={value}"), said)
            self.assertIn(words, said)

    def test_scenes_are_looked_for_in_folders(self):
        with tempfile.TemporaryDirectory() as folder:
            pathlib.Path(folder, "bunny.glb").write_text("")
            for scene in ("bunny", "bunny.glb"):
                self.assertEqual(self.checked(SCENE=scene, SCENES=f"/nowhere:{folder}"), "")
            self.assertIn(f"did you mean {folder}/bunny.glb?", self.checked(SCENE="bunyn", SCENES=folder))
            self.assertIn("no such scene", self.checked(SCENE="bunny"))

    def test_only_what_is_named_is_looked_at(self):
        every = {name: "!" for name in re.findall(r"\b[A-Z]+(?:_[A-Z]+)*\b", VALUES) if name in MAKEFILE}
        self.assertGreater(len(every), 12)
        self.assertEqual(self.checked("NONE", target="synth", **every), "")
        self.assertTrue(self.checked("CONFIG", target="synth", **every).startswith("make synth: CONFIG=!: no conf"))

    def test_nothing_is_built_for_what_is_refused(self):
        for target, word, said in (("sim", "SIZE=8", "SIZE=8 is not WIDTHxHEIGHT"), ("fit", "SIZE=8", "SIZE=8 is not"),
                                   *((target, "CONFIG=4w4d", "CONFIG=4w4d: no configuration of this name")
                                     for target in WITH_CONFIG)):  # fmt: skip
            done = make(target, word, "BUILD=/proc/none")
            self.assertEqual((done.returncode, done.stdout), (2, ""), target)
            self.assertIn(f"make {target}: {said}", done.stderr)
            self.assertNotIn("/proc/none", done.stderr)

    def test_every_target_that_is_given_a_configuration_looks_at_it(self):
        recipes = re.findall(r"^([a-z-]+):.*## .*\n((?:\t.*\n)+)", MAKEFILE, re.M)
        uses = re.compile(r"options,(CONFIG|\$\(FRAME\))|\$\(UNIT\)")
        self.assertEqual({name for name, recipe in recipes if uses.search(recipe)}, set(WITH_CONFIG))


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
        known = {name for _, name in variables()}
        commands = re.findall(r"`make ([^`]*)`", README)
        used = {name for command in commands for name in re.findall(r"\b([A-Z_]+)=", command)}
        self.assertGreater(len(used), 5)
        self.assertEqual(used - known, set())


if __name__ == "__main__":
    unittest.main()
