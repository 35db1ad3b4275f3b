"""The tables of a sweep: a row for each finished point, in the order of the experiment. They do not show where, when
or in which order points ran, so that they are the same byte for byte wherever they did; times.csv has that."""
import csv
import io
import json
import os

from .experiment import short
from .raypool import flat
from .store import write_json, write_whole

# Of a report: what the point's fields have already, and what depends on the computer.
SET_UP = (
    "raypool", "command", "config", "configuration", "engine", "scene", "view", "size", "depth", "units", "traverser",
    "boundary", "hits",
)  # fmt: skip
TIMES = ("wall_seconds", "simulation_seconds", "simulated_per_second")


def load(path):
    with open(path, encoding="utf-8") as file:
        return json.load(file)


def row_of(store, plan, planned):
    report = load(store.path("points", planned.key, "report.json"))
    results = {name: value for name, value in report.items() if name not in SET_UP + TIMES}
    point = load(store.path("points", planned.key, "point.json"))
    machine = flat(planned.machine)
    swept = {}
    for field in plan.experiment.swept:
        value = planned.point.get(field, machine.get(field))
        swept[field] = short(value) if isinstance(value, str) else value
    return {
        **swept,
        "key": planned.key,
        "machine": planned.machine["name"],
        **(planned.area or {}),
        **flat(results),
        "picture": point["picture"],
    }


def times_of(store, planned):
    report = load(store.path("points", planned.key, "report.json"))
    host = load(store.path("points", planned.key, "point.json"))["host"]
    return {"key": planned.key, "host": host, **{name: report.get(name) for name in TIMES[:2]}}


def as_csv(rows):
    columns = list(dict.fromkeys(name for row in rows for name in row))
    out = io.StringIO()
    writer = csv.DictWriter(out, columns, restval="", lineterminator="\n")
    writer.writeheader()
    # As JSON has them: true, and numbers with all their digits.
    writer.writerows({name: v if isinstance(v, str) else json.dumps(v) for name, v in row.items()} for row in rows)
    return out.getvalue()


def write(store, plan):
    """table.json, table.csv and times.csv of the points that are finished."""
    finished = [planned for planned in plan.points if store.finished(planned.key)]
    rows = [row_of(store, plan, planned) for planned in finished]
    experiment = plan.experiment
    write_json(
        store.path("table.json"),
        {
            "title": experiment.title,
            "experiment": short(os.path.abspath(experiment.path)),
            "swept": experiment.swept,
            "base": experiment.base,
            "filter": experiment.filter,
            "points": len(plan.points),
            "left_out": [
                {field: value for field, value in planned.point.items() if field in experiment.swept}
                | (planned.area or {})
                for planned in plan.left_out
            ],
            "rows": rows,
        },
    )
    write_whole(store.path("table.csv"), as_csv(rows))
    write_whole(store.path("times.csv"), as_csv([times_of(store, planned) for planned in finished]))
