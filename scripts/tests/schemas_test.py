#!/usr/bin/python3
"""The JSON Schemas describe what the program accepts and writes: scripts/tests/schemas_test.py RAYPOOL [--only CLASS]
[ENGINE...]

Checked-in configurations and views, and a report of each ENGINE (default: those without a Verilated unit), are valid;
what raypool refuses, and what it takes the schema takes, at both ends of every range; a field of what is written that
is missing, unknown or of another kind is not valid, and each is named in its page of docs/.
"""
import copy
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

import jsonschema

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
RAYPOOL = ""
ENGINES = ["native", "estimate", "functional", "sampled", "model"]


def read(path):
    return json.loads(pathlib.Path(path).read_text())


def validator(name):
    schema = read(ROOT / "schemas" / name)
    jsonschema.Draft7Validator.check_schema(schema)
    for key, inner in schema["properties"].items():
        if (other := inner.get("$ref", "")).endswith(".json"):
            schema["properties"][key] = read(ROOT / "schemas" / other)
    return jsonschema.Draft7Validator(schema)


def raypool(*words):
    return subprocess.run([RAYPOOL, *words], cwd=ROOT, capture_output=True, text=True, timeout=120, check=False)


def played_by(engine):
    """Options of sim for an engine, such as lockstep-chip-static: with boundary chip, and the traverser static."""
    engine, *more = engine.split("-")
    options = {"chip": ("--boundary", "chip"), "static": ("--traverser", "static"), "embree": ("--hits", "embree"),
               "double": ("--precision", "double")}  # fmt: skip
    return ["--engine", engine, *(word for name in more for word in options[name])]


class Agreement(unittest.TestCase):
    """Schema and program take and refuse the same documents."""

    def check(self, name, document, command):
        path = self.folder / "document.json"
        path.write_text(json.dumps(document))
        done = raypool(*[str(path) if word == "FILE" else word for word in command])
        errors = [error.message for error in validator(name).iter_errors(document)]
        self.assertIn(done.returncode, (0, 1), done.stderr)
        text = f"{document}: raypool prints '{done.stderr.strip()}', the schema {errors}"
        self.assertEqual(done.returncode == 0, not errors, text)
        return done.returncode == 0

    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)

    def test_configurations(self):
        command = ("config", "FILE")
        for path in sorted((ROOT / "configs").glob("*.json")):
            self.assertTrue(self.check("configuration.json", read(path), command), path)
        documents = [
            {"$schema": "x"},
            {"$schema": 1},
            [],
            {"name": ""},
            {"name": "a b"},
            {"name": "a" * 64},
            {"name": "a" * 65},
            {"warp": 8},
            {"alus": 3},
            {"alus": {"box": {}}},
            {"arithmetic": {"fma": 1}},
            {"arithmetic": {"slow_unit": "fast"}},
        ]
        documents += [{"warps": value} for value in (0, 1, 2, 3, 32, 64, "8", 8.5, None)]
        documents += [{"lanes": value} for value in (0, 1, 24, 32, 64)] + [{"cores": 8}]
        documents += [{"stack_depth": value} for value in (1, 2, 32, 33)]
        ends = {"registers": (8, 16), "predicates": (2, 16), "arguments": (4, 32), "pc_bits": (8, 16),
                "counter_bits": (16, 48)}  # fmt: skip
        documents += [{name: value} for name, (least, most) in ends.items()
                      for value in (least - 1, least, most, most + 1)]  # fmt: skip
        documents += [
            {f"{cache}_cache": {"bytes": value}}
            for cache in ("instruction", "data")
            for value in (256, 512, 1000, 65536, 131072)
        ]
        documents += [{"chip": chip} for chip in (3, {}, {"pool": 1}, {"ray_pool": 3}, {"ray_pool": {"bytes": 1}})]
        documents += [{"chip": {"policy": value}} for value in ("thesis", "magic", 0)]
        documents += [{"chip": {"window_remedy": value}} for value in (True, False, 0, "true")]
        documents += [{"chip": {"ray_pool": {"size": value}}} for value in (0, 1, 1 << 20, (1 << 20) + 1, "1", 1.5)]
        documents += [{"chip": {"memory": {"latency": value}}} for value in (0, 1, 10000, 10001)]
        documents += [{"data_cache": {"mshrs": value}} for value in (0, 1, 16, 17)] + [{"data_cache": {"lines": 1}}]
        for alu in json.loads(raypool("config", "8w8c", "--json").stdout)["alus"]:
            ranges = {"count": (0, 1, 2, 4, 5), "latency": (0, 1, 16, 17), "depth": (*range(14), 32, 33)}
            documents += [{"alus": {alu: {key: value}}} for key, values in ranges.items() for value in values]
        modes = [{"slow_unit": f"newton{steps}"} for steps in range(3)]
        modes += [{"fma": True}, {"fma": False}, {"subnormals": "flush"}]
        documents += [
            {"arithmetic": mode, "alus": {alu: {"depth": depth}}}
            for mode in modes
            for alu in ("slw", "flt")
            for depth in range(2, 13)
        ]
        taken = sum(self.check("configuration.json", document, command) for document in documents)
        self.assertGreater(taken, 50)
        self.assertGreater(len(documents) - taken, 50)

    def test_views(self):
        command = ("scene", "cornell", "--view", "FILE")
        for path in sorted((ROOT / "configs" / "views").glob("*.json")):
            self.assertTrue(self.check("view.json", read(path), command), path)
        good = {"eye": [0, 0, 5], "target": [0, 0, 0], "light": {"position": [1, 2, 3]}}
        changes = [
            {},
            {"$schema": "x"},
            {"up": [0, 1, 0.5]},
            {"up": [0, 1]},
            {"up": "y"},
            {"direction": [0, 0, -1]},
            {"eyes": 1},
            {"light": {}},
            {"light": None},
        ]
        changes += [{"fov": value} for value in (0.9, 1, 170, 170.5, "60")]
        changes += [{"eye": [value, 0, 5]} for value in (1e9, 1.1e9, -1e9, -1.1e9, None)]
        changes += [{"light": {"position": [1, 2, 3], "color": [value, 1, 1]}} for value in (-1, 0, 1000, 1001)]
        changes += [{"light": {"position": [1, 2, 3], "colour": [1, 1, 1]}}]
        documents = [{**good, **change} for change in changes] + [[]]
        documents += [{key: good[key] for key in good if key != left} for left in good]
        taken = sum(self.check("view.json", document, command) for document in documents)
        self.assertGreater(taken, 7)
        self.assertGreater(len(documents) - taken, 14)

    def test_descriptions_of_shaders(self):
        valid = validator("shaders.json")
        for path in sorted(ROOT.glob("cpp_model/shader/cases/*/shaders.json")):
            self.assertEqual([error.message for error in valid.iter_errors(read(path))], [], path)
        table = ROOT / "cpp_model" / "shader" / "cases" / "table"
        shutil.copytree(table, self.folder, dirs_exist_ok=True)
        good = read(table / "shaders.json")
        first = good["hit_groups"]
        changes = [
            {},
            {"geometries": "objects"},
            {"miss": "a.rmiss"},
            {"miss": good["miss"] + [{"shader": "shadow.rmiss", "values": {}}]},
            {"callable": good["callable"] + ["point.rcall"]},
            {"callable": [{"record": {}}]},
            {"hit_groups": first + [{}]},
            {"hit_groups": first + [{"closest": "a.rchit"}]},
            {"hit_groups": first + [{}] * 7},
            {"ray_generation": {"shader": "a.rgen", "record": [1]}},
            {"push_constants": 0},
        ]
        pad = "materials", {"pad_to": 64}
        for name, more in (("buffers", {}), ("colors", {}), pad, ("materials", {"pad_to": 3})):
            holds = {"address": {name: ["roughness"], **more} if more else name}
            words = [0, 0.5, holds, holds, holds, holds]
            changes.append({"bindings": [{"set": 1, "binding": 0, "holds": {"words": words}}]})
        taken = 0
        for change in changes:
            document = {**good, **change}
            (self.folder / "shaders.json").write_text(json.dumps(document))
            done = raypool("sim", "cornell", "--engine", "native", "--size", "8x8", "--quiet", "--shaders",
                           str(self.folder), "--out", str(self.folder / "out"))  # fmt: skip
            errors = [error.message for error in valid.iter_errors(document)]
            self.assertEqual(done.returncode == 0, not errors, f"{change}: '{done.stderr.strip()}', {errors}")
            taken += done.returncode == 0
        self.assertEqual(taken, 5)


class Written(unittest.TestCase):
    """What the schema of a written document must detect."""

    def fields(self, value, path=()):
        for key, inner in value.items() if isinstance(value, dict) else ():
            yield (*path, key)
            yield from self.fields(inner, (*path, key))
        for key, inner in enumerate(value) if isinstance(value, list) else ():
            yield from self.fields(inner, (*path, key))

    def changed(self, report, path, change):
        copied = copy.deepcopy(report)
        inner = copied
        for key in path[:-1]:
            inner = inner[key]
        change(inner, path[-1])
        return copied

    def refuses(self, valid, document, required, unknown):
        """Each field of another kind, each one that `required` names missing, and the `unknown` ones."""
        for path in self.fields(document):
            with self.subTest(path=path):
                other = self.changed(document, path, lambda inner, key: inner.update({key: [None]}))
                self.assertFalse(valid.is_valid(other), "of another kind")
                if required(path):
                    without = self.changed(document, path, lambda inner, key: inner.pop(key))
                    self.assertFalse(valid.is_valid(without), "missing")
        for path in unknown:
            more = self.changed(document, path, lambda inner, key: inner.update({key: 1}))
            self.assertFalse(valid.is_valid(more), f"unknown {path}")

    def names_each_field(self, page, schema):
        text = (ROOT / "docs" / page).read_text()
        found = read(ROOT / "schemas" / schema)

        def walk(part, path):
            if "$ref" in part and part["$ref"].startswith("#/definitions/"):
                part = found["definitions"][part["$ref"].split("/")[-1]]
            for key, inner in part.get("properties", {}).items():
                if path != ("configuration",):
                    self.assertTrue(
                        re.search(rf"[`.]{key}[`.]", text), f"docs/{page} does not name {'.'.join((*path, key))}"
                    )
                walk(inner, (*path, key))
            for inner in (part.get("additionalProperties"), part.get("items")):
                if isinstance(inner, dict):
                    walk(inner, path)

        walk(found, ())


class Report(Written):
    """Of small runs."""

    def test_reports(self):
        valid = validator("report.json")
        with tempfile.TemporaryDirectory() as folder:
            for engine in ENGINES:
                done = raypool(
                    "sim",
                    "--scene",
                    "cornell",
                    "--size",
                    "8x8",
                    "--config",
                    "4w4c",
                    *played_by(engine),
                    "--out",
                    folder,
                    "--json",
                )
                self.assertEqual(done.returncode, 0, done.stderr)
                report = json.loads(done.stdout)
                errors = [f"{'.'.join(map(str, error.path))}: {error.message}" for error in valid.iter_errors(report)]
                self.assertEqual(errors, [], f"{engine}: a new field of the report must be in schemas/report.json")
                self.refuses_changes(valid, report)

    def refuses_changes(self, valid, report):
        estimates = report.get("sampled", report.get("estimated", {}))
        names = set(report["kernels"]) | set(report.get("alus", {})) | set(estimates.get("alus", {}))

        # What a configuration leaves out has its default; kernels and ALUs are left open.
        def required(path):
            return len(path) == 1 or path[0] != "configuration" and path[-1] not in names | {"launches", "cycles"}

        self.refuses(valid, report, required, [("x",), ("scene", "x"), ("configuration", "x"), ("rays_by_kind", "x")])

    def test_docs_name_each_field(self):
        self.names_each_field("use/report.md", "report.json")


if __name__ == "__main__":
    RAYPOOL = str(pathlib.Path(sys.argv[1]).resolve())
    rest = sys.argv[2:]
    only, rest = (rest[1:2], rest[2:]) if rest[:1] == ["--only"] else ([], rest)
    ENGINES = rest or ENGINES
    unittest.main(argv=[sys.argv[0], *only])
