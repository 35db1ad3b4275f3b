"""The area of any machine from a table: designs of configs/areas/plan.json are mapped, and what each block takes is
fitted to the parameters that it depends on (configs/areas/osu018.json, which `raypool explore` reads).
"""
import contextlib
import json
import math
import os

import numpy

from . import elaborate, flow, report
from .errors import SynthError, say
from .library import BUILD, ROOT, Library

PLAN = os.path.join(ROOT, "configs", "areas", "plan.json")
TABLE = os.path.join(ROOT, "configs", "areas", "osu018.json")
# Coefficients are of mm2; what is below this is less than a gate.
SMALL_MM2 = 1e-9


def fields_of(config, settings):
    """{"alus.flt.count": 1, "chip.shading=kernel": 1, ...} of a configuration: its numbers, with false as 0 and true as
    1, and 1 for each name that it has."""
    words = [word for field in settings for word in ("--set", field)]
    flat = {}

    def add(value, name):
        if isinstance(value, dict):
            for key, inner in value.items():
                add(inner, f"{name}.{key}" if name else key)
        elif isinstance(value, (bool, int)):
            flat[name] = int(value)
        elif isinstance(value, str):
            flat[f"{name}={value}"] = 1

    add(json.loads(elaborate.ask(config, *words, "--json")), "")
    flat["slow_lanes"] = min(flat["slow_lanes"], flat["lanes"])
    return flat


def factor(name, fields):
    if name == "1":
        return 1
    if "=" in name:
        return fields.get(name, 0)
    if name not in fields:
        raise SynthError(f"configs/areas/plan.json: {name}: no such field")
    return fields[name]


def value_of(term, fields):
    """Of "1", "warps * lanes", "sqrt(warps * lanes)" or "chip.shading=kernel * warps"."""
    root = term.startswith("sqrt(") and term.endswith(")")
    factors = term[5:-1] if root else term
    product = math.prod(factor(name, fields) for name in factors.split(" * "))
    return math.sqrt(product) if root else product


def measured(design):
    """{block: (mm2 of logic, mm2 of memory)} at 40 nm, each with all that lies below."""
    rule = report.scaling()
    gate = rule["nand2_um2"] / design.library.nand2_area * 1e-6
    bit = rule["memory_factor"] / design.memory.scale * 1e-6
    rows, _ = report.blocks(design)
    return {row["block"]: (row["logic_um2"] * gate, row["memory_um2"] * bit) for row in rows}


def own(found, names):
    """What is left of each named block without the named blocks below it."""
    inside = {name: [] for name in names}
    top = next(iter(found))
    for name in names:
        outer = [other for other in names if name != other and (other == top or name.startswith(other + "/"))]
        if outer:
            inside[max(outer, key=lambda other: len(other) if other != top else 0)].append(name)
    return {name: tuple(found[name][i] - sum(found[inner][i] for inner in inside[name] if inner in found)
                        for i in (0, 1)) for name in names if name in found}  # fmt: skip


def map_one(entry, jobs):
    """The mapped design of an entry of the plan."""
    config, settings, units = entry["config"], entry.get("set", []), entry.get("units", 0)
    if settings:
        config = elaborate.with_fields(config, settings, os.path.join(BUILD, "configurations"))
    name = "-".join([os.path.splitext(os.path.basename(config))[0], *([f"chip-{units}"] if units else [])])
    folder = os.path.join(BUILD, "areas", name)
    os.makedirs(folder, exist_ok=True)
    design = flow.open_design(flow.Options(config=config, jobs=jobs, units=units, out=folder))
    key = flow.digest(design)
    kept = os.path.join(folder, "blocks.json")
    with contextlib.suppress(OSError, ValueError):
        with open(kept, encoding="utf-8") as file:
            found = json.load(file)
        if found["key"] == key:
            return found["blocks"]
    flow.prepare(design)
    flow.map_design(design)
    blocks = measured(design)
    with open(kept, "w", encoding="utf-8") as file:
        json.dump({"key": key, "blocks": blocks}, file)
    return blocks


def fit(terms, rows, targets):
    """Coefficients of least squares, each term's error as a share of what the block takes, as no block is more right
    than another one. Terms that the designs cannot tell apart are an error in the plan."""
    matrix = numpy.array(rows, dtype=float)
    weight = 1 / numpy.maximum(numpy.array(targets), max(targets) * 1e-3 + 1e-12)
    weighted = matrix * weight[:, None]
    scale = numpy.maximum(numpy.abs(weighted).max(axis=0), 1e-300)
    if numpy.linalg.matrix_rank(weighted / scale) < len(terms):
        raise SynthError(f"configs/areas/plan.json: its designs do not tell {', '.join(terms)} apart: add a design")
    found, *_ = numpy.linalg.lstsq(weighted / scale, numpy.array(targets) * weight, rcond=None)
    return found / scale


def area_of(table, fields, units):
    """mm2 of a chip of so many units; 0: of a unit alone."""
    fields = {**fields, "units": units}
    total = 0.0
    for block in table["blocks"]:
        of_unit = block["scope"] == "unit"
        if units == 0 and not of_unit:
            continue
        area = sum(value_of(term, fields) * mm2 for term, mm2 in block["mm2"].items())
        total += area * (max(units, 1) if of_unit else 1)
    return total


def table_of(plan, designs):
    """`designs`: (entry, fields, blocks) of each."""
    blocks = []
    for scope, terms_of in plan["blocks"].items():
        rows_of = {name: ([], []) for name in terms_of}
        for entry, fields, found in designs:
            if (scope == "unit") != ("units" not in entry):
                continue
            fields = {**fields, "units": entry.get("units", 0)}
            for name, (logic, memory) in own(found, [*terms_of, *plan["apart"]]).items():
                if name in terms_of:
                    rows_of[name][0].append([value_of(term, fields) for term in terms_of[name]])
                    rows_of[name][1].append(logic + memory)
        for name, terms in terms_of.items():
            rows, targets = rows_of[name]
            if not rows:
                raise SynthError(f"configs/areas/plan.json: no design has the block {name}")
            found = fit(terms, rows, targets)
            kept = {term: float(f"{mm2:.6g}") for term, mm2 in zip(terms, found) if abs(mm2) > SMALL_MM2}
            blocks.append({"block": name, "scope": scope, "mm2": kept})
    return {"library": Library(None).name, "rule": report.scaling()["rule"], "blocks": blocks}


def make(jobs, check=False):
    """Maps the designs of the plan and writes the table; with `check` those of its list "check" beside the table."""
    with open(PLAN, encoding="utf-8") as file:
        plan = json.load(file)
    entries = plan["check" if check else "designs"]
    designs = []
    for number, entry in enumerate(entries, 1):
        say(f"areas: {number} of {len(entries)}: {entry['config']} {' '.join(entry.get('set', []))}"
            f"{' chip of ' + str(entry['units']) if 'units' in entry else ''}")  # fmt: skip
        designs.append((entry, fields_of(entry["config"], entry.get("set", [])), map_one(entry, jobs)))
    if check:
        with open(TABLE, encoding="utf-8") as file:
            table = json.load(file)
    else:
        table = table_of(plan, designs)
    worst = 0.0
    say(f"{'design':72} {'mm2':>8} {'table':>8} {'error':>7}")
    for entry, fields, found in designs:
        whole, estimate = sum(next(iter(found.values()))), area_of(table, fields, entry.get("units", 0))
        error = estimate / whole - 1
        worst = max(worst, abs(error))
        name = f"{entry['config']} {' '.join(entry.get('set', []))}"
        name = f"{entry['units']} x {name}" if "units" in entry else name
        say(f"{name[:72]:72} {whole:8.3f} {estimate:8.3f} {100 * error:+6.1f}%")
    say(f"areas: {len(designs)} designs, the largest error {100 * worst:.1f}%")
    if not check:
        with open(TABLE + ".new", "w", encoding="utf-8") as file:
            json.dump(table, file, indent=1)
            file.write("\n")
        os.rename(TABLE + ".new", TABLE)
        say(f"areas: {os.path.relpath(TABLE)}")
