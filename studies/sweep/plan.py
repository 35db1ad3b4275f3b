"""From an experiment to what is to be run: every point checked by raypool, and given a key that covers all that its
result depends on."""
import hashlib
import json
import os
import re
import tempfile
from concurrent import futures

from . import area, raypool, scenes
from .errors import SweepError
from .experiment import RUN_FIELDS, short, text
from .expression import Filter

# Beside the fields of a point a filter may use these.
DERIVED = ("contents", "width", "height")
AREA = ("area_mm2", "kge")


class Planned:
    """A point that is to be run. `key` names its folder."""

    def __init__(self, number, point, settings):
        self.number, self.point, self.settings = number, point, settings
        self.machine = None
        self.area = None
        self.key = ""
        self.job = {}


class Plan:
    """`points` in the experiment's order, `left_out` by the filter. Throws SweepError before anything has run."""

    def __init__(self, experiment, jobs, progress):
        self.experiment = experiment
        self.jobs = jobs
        self.progress = progress
        self.program = raypool.digest_of_file(raypool.PROGRAM)
        self.versions = raypool.ask("--version")
        self.digests = {}
        self.points = [
            Planned(number, point, {field: text(value) for field, value in point.items() if field not in RUN_FIELDS})
            for number, point in enumerate(experiment.points, 1)
        ]
        self.check_machines()
        self.check_runs()
        self.check_scenes()
        self.left_out = self.filter()
        self.check_fields()
        self.find_units()
        for planned in self.points:
            self.give_key(planned)

    def each_once(self, what, identity, action):
        """action(point) for one point of each identity, several at a time; a failure names the first point it is of."""
        groups = {}
        for planned in self.points:
            groups.setdefault(identity(planned), []).append(planned)
        results = {}
        with futures.ThreadPoolExecutor(self.jobs) as pool:
            waiting = {key: pool.submit(action, group[0]) for key, group in groups.items()}
            try:
                for done, (key, future) in enumerate(waiting.items(), 1):
                    results[key] = self.result(future, groups[key][0])
                    self.progress.show(f"  {what}: {done} of {len(groups)}")
            except BaseException:
                # An interrupt does not wait for what has not begun, nor does an error.
                pool.shutdown(wait=False, cancel_futures=True)
                raise
        return {planned: results[key] for key, group in groups.items() for planned in group}

    def result(self, future, planned):
        try:
            return future.result()
        except SweepError as error:
            raise self.error(planned, error) from error

    def error(self, planned, error):
        shown = self.experiment.shown(planned.point)
        return SweepError(f"{self.experiment.path}: point {planned.number} ({shown}): {error}")

    def check_machines(self):
        def machine_of(planned):
            return raypool.machine(planned.point["config"], planned.settings)

        def identity(planned):
            return planned.point["config"], *planned.settings.items()

        for planned, machine in self.each_once("machines checked", identity, machine_of).items():
            planned.machine = machine

    def check_runs(self):
        """Each value of the other options once, by a call that draws nothing."""
        for field in ("size", "depth", "units", "detail"):

            def check(planned, field=field):
                words = ["sim", "cornell", "--modules", "--engine", "model", "--detail", "0.01"]
                words = words[:-2] if field == "detail" else words
                raypool.ask(*words, f"--{field}={text(planned.point[field])}")

            self.each_once(f"values of {field} checked", lambda planned, field=field: text(planned.point[field]), check)

        def engine(planned):
            fields = {field: planned.point[field] for field in ("engine", "boundary", "hits")}
            fields["traverser"] = planned.settings.get("chip.traverser", "")
            return tuple(f"--{field}={text(value)}" for field, value in fields.items() if value != "")

        def check_engine(planned):
            point = planned.point
            # A Verilated device may have to be built first; the native engine has no chip to print, and draws a pixel.
            if point["engine"] in raypool.VERILATED and point["hits"] == "":
                return
            with tempfile.TemporaryDirectory() as out:
                how = ["--size=1x1", "--quiet", f"--out={out}"] if point["engine"] == "native" else ["--modules"]
                raypool.ask("sim", "cornell", "--detail=0.01", *engine(planned), *how)

        self.each_once("engines checked", engine, check_engine)
        self.check_shaders()

    def check_shaders(self):
        """Each set once, on each machine and at each depth, by drawing a pixel.

        The machine gets what raypool adds to it, as chip.miss_records.
        """

        def identity(planned):
            point = planned.point
            return (point["shaders"], point["config"], *planned.settings.items(),
                    *(text(point[field]) for field in ("depth", "units", "samples")))  # fmt: skip

        def machine_of(planned):
            point = planned.point
            if point["shaders"] == "" and point["samples"] == 1:
                return planned.machine
            words = [f"--{field}={text(point[field])}" for field in ("depth", "units", "samples")]
            words += ["--shaders", point["shaders"]] if point["shaders"] else []
            with tempfile.TemporaryDirectory() as out:
                raypool.ask("sim", *raypool.machine_words(point["config"], planned.settings), "--scene=cornell",
                            "--detail=0.01", "--engine=native", "--size=1x1", "--quiet", f"--out={out}",
                            *words)  # fmt: skip
                with open(os.path.join(out, "report.json"), encoding="utf-8") as file:
                    return json.load(file)["configuration"]

        for planned, machine in self.each_once("shader sets checked", identity, machine_of).items():
            planned.machine = machine

    def check_scenes(self):
        def check(planned):
            point = planned.point
            if point["scene"] not in scenes.BUILT_IN and not os.path.isfile(point["scene"]):
                raise SweepError(scenes.missing(point["scene"], self.experiment.scene_source))
            view = ["--view", point["view"]] if point["view"] else []
            raypool.ask("scene", point["scene"], *view, "--detail", text(point["detail"]))

        def identity(planned):
            return planned.point["scene"], planned.point["view"], text(planned.point["detail"])

        self.each_once("scenes checked", identity, check)

    def values(self, planned):
        """What a filter may use."""
        machine = raypool.flat(planned.machine)
        width, height = str(planned.point["size"]).lower().split("x")
        values = {**machine, **{field: planned.point[field] for field in RUN_FIELDS}}
        values.update(contents=machine["warps"] * machine["lanes"], width=int(width), height=int(height))
        values.update(planned.area or {})
        return values

    def filter(self):
        experiment = self.experiment
        condition = None
        if experiment.filter is not None:
            known = [*self.values(self.points[0]), *DERIVED, *AREA]
            try:
                condition = Filter(experiment.filter, known)
            except SweepError as error:
                raise SweepError(f"{experiment.path}: {error}") from error
        if experiment.area or (condition and condition.names & set(AREA)):
            areas = area.Areas(self.progress, experiment.area == "chip", experiment.power)
            for planned in self.points:
                try:
                    planned.area = areas.of(planned)
                except SweepError as error:
                    raise self.error(planned, error) from error
        if condition is None:
            return []
        left_out = []
        for planned in self.points:
            try:
                if not condition.passes(self.values(planned)):
                    left_out.append(planned)
            except SweepError as error:
                raise self.error(planned, error) from error
        gone = set(left_out)
        self.points = [planned for planned in self.points if planned not in gone]
        if not self.points:
            raise SweepError(
                f"{experiment.path}: the filter '{experiment.filter}' leaves out all {len(left_out)} points"
            )
        return left_out

    def check_fields(self):
        """No point that is left names a field that its machine does not look at: it would be another one's twin."""

        def identity(planned):
            return planned.point["config"], *planned.settings.items()

        def check(planned):
            raypool.ask_config(planned.point["config"], planned.settings, "--in-use", "--json")

        self.each_once("fields checked", identity, check)

    def find_units(self):
        """The Verilated unit or chip of each point that needs one is there, and of today's Verilog."""

        def build(planned):
            point = planned.point
            boundary = [f"--boundary={point['boundary']}"] if point["boundary"] else []
            said = raypool.ask("unit", *raypool.machine_words(point["config"], planned.settings),
                               f"--units={text(point['units'])}", *boundary)  # fmt: skip
            return re.findall(r"\S+/libraypool_\w+\.so", said)[-1]

        def identity(planned):
            if planned.point["engine"] not in raypool.VERILATED:
                return None
            return json.dumps([planned.machine, planned.point["units"], planned.point["boundary"]])

        # One at a time: building takes all cores.
        self.units = {}
        for number, planned in enumerate(self.points, 1):
            wanted = identity(planned)
            if wanted is None or wanted in self.units:
                continue
            self.progress.show(f"  Verilated unit of point {number}; a new one takes a minute or more", now=True)
            try:
                self.units[wanted] = build(planned)
            except SweepError as error:
                raise self.error(planned, error) from error
        for planned in self.points:
            planned.unit = self.units.get(identity(planned))

    def digest(self, path):
        if path not in self.digests:
            self.digests[path] = raypool.digest_of_file(path)
        return self.digests[path]

    def give_key(self, planned):
        point = planned.point
        words = ["sim", *raypool.machine_words(point["config"], planned.settings)]
        for field in RUN_FIELDS:
            if field != "config" and point[field] != "":
                words.append(f"--{field}={text(point[field])}")
        files = []
        if os.path.isfile(point["scene"]):
            files += scenes.files_of(point["scene"])
        files += [point["view"]] if point["view"] else []
        files += [planned.unit] if planned.unit else []
        files += raypool.files_of_shaders(point["shaders"])
        words += [f"--unit-library={planned.unit}"] if planned.unit else []
        depends_on = {
            "program": self.program,
            "versions": self.versions,
            "machine": planned.machine,
            # A file counts with its name, which the report has, and its content, not with its folder.
            "fields": {field: os.path.basename(text(point[field])) for field in RUN_FIELDS},
            "files": [[os.path.basename(path), self.digest(path)] for path in files],
        }
        planned.key = hashlib.sha256(json.dumps(depends_on, sort_keys=True).encode()).hexdigest()[:20]
        planned.job = {
            "key": planned.key,
            "point": {field: short(value) if isinstance(value, str) else value for field, value in point.items()},
            "program": raypool.PROGRAM,
            "arguments": words,
            "machine": planned.machine,
            "digests": {raypool.PROGRAM: self.program, **{path: self.digest(path) for path in files}},
            "depends_on": depends_on,
        }
