"""Which synthesis report is that of a point's unit: the one with the same Verilog parameters."""
import json
import os
import tempfile

from sweep import raypool
from sweep.errors import SweepError


def parameters_of(unit):
    """Of the Verilog, as texts, by name; None for a configuration that today's program does not take."""
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "unit.json")
        with open(path, "w", encoding="utf-8") as file:
            json.dump(unit, file)
        try:
            lines = raypool.ask("config", path, "--verilog-parameters").splitlines()
        except SweepError:
            return None
    return dict(line.split("=", 1) for line in lines)


def find_areas(points, synthesis):
    """Gives points power, their area if their sweep has not, and the clock that each library allows. Of several reports
    the last with power, else the last."""
    known, clocks = {}, {}
    for report in synthesis:
        identity = json.dumps(report["parameters"], sort_keys=True)
        clocks.setdefault(identity, {})[report["library"]["name"]] = 1000 / report["timing"]["allowed_ns"]
        if identity not in known or report.get("power") or not known[identity].get("power"):
            known[identity] = report
    if not known:
        return
    asked = {}
    for point in points:
        unit = {name: value for name, value in point.report["configuration"].items() if name not in ("chip", "name")}
        key = json.dumps(unit, sort_keys=True)
        if key not in asked:
            identity = json.dumps(parameters_of(unit), sort_keys=True)
            asked[key] = known.get(identity), clocks.get(identity, {})
        report, point.clocks = asked[key]
        if report:
            take(point, report)


def take(point, report):
    units = point["units"]
    if point.area_mm2 is None:
        point.area_mm2 = units * report["forty_nm"]["total_mm2"]
        point.kge = units * report["area"]["total_kge"]
    if report.get("power"):
        point.watts = units * report["power"]["total_w"]
        point.watts_mhz = 1000 / report["timing"]["clock_ns"]
        point.watts_library = report["library"]["name"]
