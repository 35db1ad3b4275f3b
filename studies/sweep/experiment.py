"""An experiment's file: read, and made into points. Whether a point can be run is checked in plan.py."""
import itertools
import json
import math
import os

import jsonschema

from . import scenes
from .errors import SweepError, nearest, nearest_file
from .raypool import ROOT

MOST_POINTS = 10000
# What raypool sim takes as an option of its own, with its default; every other field is one of the machine.
RUN_FIELDS = {
    "scene": "room",
    "view": "",
    "size": "200x200",
    "depth": 3,
    "detail": 1,
    "config": "8w8c",
    "units": 1,
    "engine": "model",
    "boundary": "",
    "hits": "",
    "shaders": "",
    "samples": 1,
}


class Experiment:
    """Checked as to its form; `points` are dicts of all that was given for each."""

    def __init__(self, path, settable):
        self.path = path
        self.document = read(path)
        check_form(path, self.document)
        self.title = self.document.get("title") or os.path.splitext(os.path.basename(path))[0]
        self.base = self.document.get("base", {})
        self.product = self.document.get("product", {})
        self.listed = self.document.get("points", [{}])
        self.filter = self.document.get("filter")
        self.scene_source = self.document.get("scene_source")
        self.area = self.document.get("area", False)
        self.power = self.document.get("power", False)
        if self.power and not self.area:
            raise SweepError(f"{path}: power is of synthesised units: it needs \"area\": true")
        self.check_fields(settable)
        number = len(self.listed) * math.prod(len(values) for values in self.product.values())
        if number > MOST_POINTS:
            raise SweepError(f"{path}: that is {number:,} points; a sweep has at most {MOST_POINTS:,}")
        self.swept = list(dict.fromkeys([*itertools.chain(*self.listed), *self.product]))
        self.points = [
            self.resolved({**self.base, **point, **dict(zip(self.product, values))})
            for point in self.listed
            for values in itertools.product(*self.product.values())
        ]

    def check_fields(self, settable):
        known = set(settable) | set(RUN_FIELDS)
        places = [("base", self.base), ("product", self.product)]
        places += [(f"point {number} of points", point) for number, point in enumerate(self.listed, 1)]
        for place, fields in places:
            for field, value in fields.items():
                if field not in known:
                    raise SweepError(
                        f"{self.path}: {place}: there is no field '{field}'{nearest(field, known)} "
                        "(raypool config prints those of the machine)"
                    )
                for each in value if isinstance(value, list) else [value]:
                    named = field in ("scene", "view", "config", "shaders")
                    if isinstance(each, str) and not named and each.split() != [each]:
                        raise SweepError(f"{self.path}: {place}: {field} is '{each}'; it must be one word")
        twice = next((field for point in self.listed for field in point if field in self.product), None)
        if twice:
            raise SweepError(f"{self.path}: {twice} stands both in product and in points: it can have one value only")

    def resolved(self, given):
        """With all run fields; files named relative to the experiment's file."""
        point = {**RUN_FIELDS, **given}
        folder = os.path.dirname(os.path.abspath(self.path))
        if point["scene"] not in scenes.BUILT_IN:
            try:
                point["scene"] = scenes.find(str(point["scene"]), folder)
            except SweepError as error:
                raise SweepError(f"{self.path}: {error}") from error
        for field in ("view", "config", "shaders"):
            value = str(point[field])
            is_file = {
                "view": value != "",
                "config": value.endswith(".json") or "/" in value,
                "shaders": "/" in value,
            }[field]
            point[field] = os.path.normpath(os.path.join(folder, value)) if is_file else value
        return point

    def shown(self, point):
        """'depth=3, warps=4': what distinguishes a point from the others."""
        shown = (f"{field}={short(point[field])}" for field in self.swept if field in point)
        return ", ".join(shown) or "the only one"


def short(value):
    """Files of the project by their place in it."""
    return os.path.relpath(value, ROOT) if isinstance(value, str) and value.startswith(ROOT + "/") else text(value)


def text(value):
    """As raypool takes it."""
    return json.dumps(value) if isinstance(value, (bool, float)) else str(value)


def read(path):
    try:
        with open(path, encoding="utf-8-sig") as file:
            return json.load(file, object_pairs_hook=once)
    except FileNotFoundError as error:
        near = nearest_file(path, [os.path.join(ROOT, "configs", "experiments")])
        raise SweepError(f"{path}: there is no such experiment{near}") from error
    except OSError as error:
        raise SweepError(f"{path}: cannot be read: {error.strerror}") from error
    except (ValueError, RecursionError) as error:
        raise SweepError(f"{path}: not valid JSON: {error}") from error


def once(pairs):
    """A key that stands twice would lose its first value without a word."""
    for number, (key, _) in enumerate(pairs):
        if any(key == other for other, _ in pairs[:number]):
            raise ValueError(f"'{key}' stands twice")
    return dict(pairs)


def check_form(path, document):
    with open(os.path.join(ROOT, "schemas", "experiment.json"), encoding="utf-8") as file:
        schema = json.load(file)
    error = jsonschema.exceptions.best_match(jsonschema.Draft7Validator(schema).iter_errors(document))
    if error is None:
        return
    place = ".".join(str(part + 1) if isinstance(part, int) else part for part in error.absolute_path)
    place = f"{path}: {place}: " if place else f"{path}: "
    if error.validator == "additionalProperties":
        unknown = next(key for key in document if key not in schema["properties"])
        raise SweepError(f"{place}there is no '{unknown}'{nearest(unknown, schema['properties'])} (there are "
                         f"{', '.join(key for key in schema['properties'] if key[0] != '$')})")
    if error.validator in ("minItems", "minLength"):
        raise SweepError(f"{place}is empty: give at least one value, or leave it out")
    kinds = error.validator_value if isinstance(error.validator_value, list) else [error.validator_value]
    raise SweepError(f"{place}is {json.dumps(error.instance)[:60]}; it must be {' or '.join(map(str, kinds))}")
