"""Finds what a page is made from: sweeps, runs and synthesis reports in folders. What is broken is named in
`Sources.notes`, one sentence each, and left out."""
import json
import os

import jsonschema

from sweep.raypool import ROOT

from .errors import ReportError
from .point import Point, Sweep, near

SYNTHESIS_SCHEMA = "raypool-synth-2"


class Broken(Exception):
    """A report that is left out; its text says why."""


def load(path):
    try:
        with open(path, encoding="utf-8") as file:
            document = json.load(file)
    except OSError as error:
        raise Broken(f"{near(path)} cannot be read ({error.strerror})") from error
    except (ValueError, RecursionError) as error:
        raise Broken(f"{near(path)} is not valid JSON ({error})") from error
    if not isinstance(document, dict):
        raise Broken(f"{near(path)} is not a report: it is no JSON object")
    return document


def report_validator():
    schemas = {}
    for name in ("report", "configuration"):
        with open(os.path.join(ROOT, "schemas", name + ".json"), encoding="utf-8") as file:
            schemas[name] = json.load(file)
    schemas["report"]["properties"]["configuration"] = schemas["configuration"]
    return jsonschema.Draft7Validator(schemas["report"])


class Sources:
    """`sweeps` and single `runs` (Points), `synthesis` (reports with their `path`); each in the order of the folders
    and below them of the alphabet."""

    def __init__(self, folders):
        self.sweeps, self.runs, self.synthesis, self.notes = [], [], [], []
        self.validator = report_validator()
        for folder in folders:
            self.add_place(folder)
        if not (self.sweeps or self.runs or self.synthesis):
            places = ", ".join(near(folder) for folder in folders)
            broken = f" ({len(self.notes)} broken: {self.notes[0]})" if self.notes else ""
            raise ReportError(f"there is no sweep, run or synthesis report in {places}{broken}: "
                              "make sim or make sweep EXPERIMENT=configs/experiments/caches.json leaves one")

    def add_place(self, folder):
        """One of these, or a folder of them."""
        if self.add_folder(folder):
            return
        for name in sorted(os.listdir(folder)):
            path = os.path.join(folder, name)
            if os.path.isdir(path):
                self.add_folder(path)

    def add_folder(self, folder):
        """False if it holds nothing of these."""
        try:
            if os.path.isfile(os.path.join(folder, "table.json")):
                self.add_sweep(folder)
            elif os.path.isfile(os.path.join(folder, "report.json")):
                self.add_report(folder)
            elif os.path.isdir(os.path.join(folder, "points")):
                raise Broken(f"{near(folder)} has points and no table.json, as the sweep has not come to its end: "
                             "the same make sweep goes on")
            else:
                return False
        except Broken as broken:
            self.notes.append(str(broken))
        return True

    def add_report(self, folder):
        path = os.path.join(folder, "report.json")
        document = load(path)
        if "schema" not in document:
            self.runs.append(Point(self.checked(path, document), folder))
            return
        if document["schema"] != SYNTHESIS_SCHEMA:
            raise Broken(f"{near(path)} is of another version of make synth ({document['schema']}): make it again")
        if not is_synthesis(document):
            raise Broken(f"{near(path)} is a synthesis report without parameters, area or clock: make it again")
        self.synthesis.append({**document, "path": near(path)})

    def add_sweep(self, folder):
        path = os.path.join(folder, "table.json")
        table = load(path)
        rows = table.get("rows")
        if not isinstance(rows, list) or not all(isinstance(row, dict) and "key" in row for row in rows):
            raise Broken(f"{near(path)} is not the table of a sweep: make sweep writes it again")
        sweep = Sweep(near(folder), table)
        for row in rows:
            place = os.path.join(folder, "points", str(row["key"]))
            try:
                report = os.path.join(place, "report.json")
                point = Point(self.checked(report, load(report)), place, sweep, row)
                point.versions = str(load(os.path.join(place, "point.json"))["depends_on"]["versions"])
                sweep.points.append(point)
            except (KeyError, TypeError):
                self.notes.append(f"{near(place)}/point.json is not that of a point: remove the folder, and the same "
                                  "make sweep runs it again")
            except Broken as broken:
                self.notes.append(str(broken))
        if sweep.points:
            self.sweeps.append(sweep)
        elif not rows:
            self.notes.append(f"{near(path)} has no finished point: the same make sweep goes on")

    def checked(self, path, document):
        """By schemas/report.json, but for what a newer version may have added."""
        errors = [error for error in self.validator.iter_errors(document) if error.validator != "additionalProperties"]
        if errors:
            error = min(errors, key=lambda error: (len(error.absolute_path), str(error.absolute_path)))
            where = ".".join(map(str, error.absolute_path))
            raise Broken(f"{near(path)} is not a report of this version of raypool sim: {where + ': ' if where else ''}"
                         f"{error.message[:100]}; run it again")
        return document

    @property
    def points(self):
        return [point for sweep in self.sweeps for point in sweep.points] + self.runs


def is_synthesis(document):
    """Has what the page takes from it."""
    def number(*path):
        value = document
        for name in path:
            value = value.get(name) if isinstance(value, dict) else None
        return isinstance(value, (int, float)) and value > 0

    clock = number("timing", "clock_ns") and number("timing", "allowed_ns")
    found = clock and number("area", "total_kge") and number("forty_nm", "total_mm2")
    powered = not document.get("power") or number("power", "total_w")
    return isinstance(document.get("parameters"), dict) and found and powered
