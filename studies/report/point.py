"""A point: one run with all that the page needs to know of it."""
import json
import os
import shlex

from sweep.raypool import ROOT, flat

TIMED = ("model", "rtl", "lockstep")
# Of a run, beside the machine's; in this order where points are distinguished.
RUN_FIELDS = ("scene", "view", "size", "depth", "units", "engine")
# What is shown of an engine beside its name: boundary or hits, where they are not the default.
OF_ENGINE = {"chip": " chip", "embree": " embree"}


def near(path):
    """As seen from the project, if it is in it."""
    path = os.path.abspath(path)
    return os.path.relpath(path, ROOT) if path.startswith(ROOT + os.sep) else path


class Sweep:
    def __init__(self, folder, table):
        self.folder = folder
        self.title = str(table.get("title") or os.path.basename(folder))
        self.experiment = table.get("experiment")
        self.points = []

    @property
    def command(self):
        return f"make sweep EXPERIMENT={shlex.quote(self.experiment)}" if self.experiment else None


class Point:
    """`fields`: what was chosen, by name; `report`: what came of it. `number` is its row on the page."""

    def __init__(self, report, folder, sweep=None, row=None):
        self.report, self.folder, self.sweep, self.row = report, folder, sweep, row or {}
        self.versions = None
        self.number = 0
        self.area_mm2 = self.row.get("area_mm2")
        self.kge = self.row.get("kge")
        self.watts = self.watts_mhz = self.watts_library = None
        self.clocks = {}  # MHz that each library allows
        machine = {name: value for name, value in flat(report["configuration"]).items() if name != "name"}
        size = report["size"]
        self.fields = {
            "scene": f"{report['scene']['name']} ({report['scene']['triangles']:,} triangles)",
            "view": json.dumps(report["view"]),
            "size": f"{size['width']}x{size['height']}",
            **{name: report[name] for name in ("depth", "units")},
            "engine": report["engine"] + OF_ENGINE.get(report.get("boundary") or report.get("hits"), ""),
            **machine,
        }

    def __getitem__(self, field):
        return self["warps"] * self["lanes"] if field == "contents" else self.fields.get(field)

    @property
    def machine(self):
        return self.report["configuration"]["name"]

    @property
    def shape(self):
        return f"{self['warps']}w{self['lanes']}c"

    @property
    def rate(self):
        """Mrays/s, None for engines without time."""
        return self.report["mrays_per_second"]

    @property
    def timed(self):
        return self.report["engine"] in TIMED

    @property
    def is_embrees(self):
        return self.report.get("hits") == "embree"

    @property
    def version(self):
        """'raypool 0.1.0 (commit)'; a run outside sweeps does not know its commit."""
        return self.versions.splitlines()[0] if self.versions else f"raypool {self.report['raypool']}"

    @property
    def size_words(self):
        return f"{self.report['size']['width']} x {self.report['size']['height']}"

    @property
    def picture(self):
        path = os.path.join(self.folder, "image.png")
        return path if os.path.isfile(path) else None

    @property
    def command(self):
        """That makes this run again, as you type it in the project's folder."""
        words = iter(self.report["command"][1:])
        kept = ["raypool"]
        for word in words:
            if word == "--out":
                next(words, None)
            elif word != "--quiet" and not word.startswith("--out="):
                kept.append(word.replace(ROOT + os.sep, ""))
        return shlex.join(kept)

    def key(self, *without):
        """Equal for points that differ in nothing but these fields."""
        return tuple(sorted((name, str(value)) for name, value in self.fields.items() if name not in without))


def differing(points, *without):
    """Names of the fields that are not the same in all points."""
    names = dict.fromkeys([*RUN_FIELDS, *(name for point in points for name in point.fields)])
    return [name for name in names if name not in without and len({str(point[name]) for point in points}) > 1]


def short_field(name, value):
    """'depth 3', '8 warps', 'policy fill'."""
    if name in ("warps", "lanes"):
        return f"{value} {name if value != 1 else name[:-1]}"
    if name == "units":
        return f"{value} unit{'s' if value != 1 else ''}"
    if name in ("engine", "size"):
        return str(value)
    if name == "scene":
        return str(value).split(" (")[0]
    if name == "view":
        return "view " + ",".join(f"{part:g}" for part in json.loads(value)["eye"])
    return f"{name.removeprefix('chip.').replace('alus.', '').replace('arithmetic.', '')} {text(value)}"


def text(value):
    return str(value).lower() if isinstance(value, bool) else str(value)


def labels(points, *without):
    """A name for each point, of the fields in which it differs from others: '8w4c, depth 3'."""
    names = differing(points, *without)
    shape = {"warps", "lanes"} & set(names)
    found = []
    for point in points:
        parts = [point.shape] if shape or not names else []
        parts += [short_field(name, point[name]) for name in names if name not in shape]
        found.append(", ".join(parts))
    return found


def common(points):
    """What points have in common, in words: 'room, 64x64, depth 3, 1 unit, engine model'."""
    first = points[0]
    different = set(differing(points))
    words = [short_field(name, first[name]) for name in ("scene", "size", "depth", "units") if name not in different]
    words += [f"engine {first['engine']}"] if "engine" not in different else []
    words += [first.shape] if not {"warps", "lanes"} & different else []
    words += [f"policy {first['chip.policy']}"] if "chip.policy" not in different and first["chip.policy"] else []
    return ", ".join(words)
