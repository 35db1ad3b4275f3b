"""report.json of a synthesised unit or chip, its table, and the comparison with an earlier one.
docs/use/synthesis.md explains the fields.
"""
import json
import os
import statistics
from collections import defaultdict

from . import mapping, timing
from .errors import SynthError
from .library import ROOT

SCHEMA = "raypool-synth-2"
THESIS_MM2 = 0.537
# The clock of the simulated chip, and so of a run's Mrays/s.
SIMULATED_MHZ = 1000
# A stage should take no more than this many times the median one.
SLOW_STAGE = 4 / 3
# Lanes with a goal for their size in kGE: (block, name, [(parameters, goal)]), the first that fits.
GOALS = [
    ("float_lane", "Flt lane", [({"FMA": "1"}, 14.0), ({"SUBNORMALS": "0"}, 12.0), ({"SUBNORMALS": "1"}, 10.5)]),
    ("slow_lane", "Slw lane", [({"SLOW_UNIT": "0"}, 28.0), ({"SLOW_UNIT": "2"}, 15.0)]),
]


def published():
    """Rows of the chips of constraints/published.json: what is known of each, and Mrays/s a mm2 at 40 nm."""
    with open(os.path.join(ROOT, "constraints", "published.json"), encoding="utf-8") as file:
        chips = json.load(file)["chips"]
    lines = []
    for chip in chips:
        scaled = chip["mm2"] * (40 / chip["nm"]) ** 2
        rates = chip["mrays_per_second"]
        a_mm2 = " to ".join(f"{rate / scaled:.1f}" for rate in rates)
        lines.append(
            f"beside   {chip['name']}: {' to '.join(map(str, rates))} Mrays/s ({chip['scene']}), {chip['mm2']} mm2 at "
            f"{chip['nm']} nm, {scaled:.1f} at 40: {a_mm2} a mm2; {chip['clock']}"
        )
    return lines


def scaling():
    with open(os.path.join(ROOT, "constraints", "scaling.json"), encoding="utf-8") as file:
        return json.load(file)


def base_path(design, path):
    """The block of an instance path, by the names of its modules: flt_alu/float_lane/float_adder."""
    identity, names = design.netlist.top, []
    for instance in path:
        identity = design.netlist.modules[identity].blocks[instance][0]
        names.append(design.kinds[identity].base)
    return "/".join(names)


def blocks(design):
    """One row for each block of the hierarchy, all instances of a place together; areas include what lies below."""
    netlist, library = design.netlist, design.library
    rows = defaultdict(
        lambda: {
            "instances": 0,
            "logic_um2": 0.0,
            "own_um2": 0.0,
            "clocked_um2": 0.0,
            "memory_um2": 0.0,
            "flip_flops": 0,
            "memory_bits": 0,
            "cells": 0,
        }
    )
    stay = {k.identity for k in design.blocks()}
    of_path = {}
    for path, identity in netlist.instances():
        name = base_path(design, path)
        of_path["/".join(path)] = name
        row = rows[name]
        row["instances"] += 1
        if identity in stay:
            price = design.memory.price(design.kinds[identity])
            change = {"memory_um2": price.nominal, "memory_bits": price.bits}
        else:
            change = {
                "logic_um2": netlist.own_area(identity),
                "clocked_um2": netlist.own_clocked_area(identity),
                "flip_flops": netlist.own_flops(identity),
                "cells": sum(netlist.gate_count(identity).values()),
            }
            row["own_um2"] += change["logic_um2"]
        for depth in range(len(path) + 1):
            upper = rows[base_path(design, path[:depth])]
            for key, value in change.items():
                upper[key] += value
    worst = {}
    for end in design.endpoints:
        path = end.pin.split("/")[:-1]
        while path and "/".join(path) not in of_path:
            path = path[:-1]
        name = of_path["/".join(path)]
        worst.setdefault(name, end)
    listed = []
    for name in sorted(rows, key=lambda n: (n.count("/") if n else -1, -rows[n]["logic_um2"] - rows[n]["memory_um2"])):
        row = rows[name]
        end = worst.get(name)
        listed.append(
            {
                "block": name or design.top,
                **{k: round(v, 1) if isinstance(v, float) else v for k, v in row.items()},
                "logic_kge": round(library.kge(row["logic_um2"]), 3),
                "memory_kge": round(library.kge(row["memory_um2"]), 3),
                "slack_ns": end.slack if end else None,
                "delay_ns": round(design.clock_ns - end.slack, 4) if end else None,
                "endpoint": end.pin if end else None,
            }
        )
    return listed, of_path


def block_of(design, of_path, pin):
    path = pin.split("/")[:-1]
    while path and "/".join(path) not in of_path:
        path = path[:-1]
    return of_path["/".join(path)] or design.top


def forty_nm(design, logic_um2):
    """mm2 at 40 nm by the rule of constraints/scaling.json."""
    rule = scaling()
    gates = logic_um2 / design.library.nand2_area
    result = {}
    instances = [i for _, i in design.netlist.instances()]
    stay = {k.identity: k for k in design.blocks()}
    prices = [design.memory.price_at_reference(stay[i]) for i in instances if i in stay]
    for end, index in (("", 1), ("_low", 2), ("_high", 3)):
        result["logic_mm2" + end] = gates * rule["nand2_um2" + end] * 1e-6
        result["memory_mm2" + end] = sum(p[index] for p in prices) * rule["memory_factor" + end] * 1e-6
        result["total_mm2" + end] = result["logic_mm2" + end] + result["memory_mm2" + end]
    result["memory_mm2_high"] = max(result["memory_mm2_high"], result["memory_mm2"])
    result["total_mm2_high"] = result["logic_mm2_high"] + result["memory_mm2_high"]
    return {**{k: round(v, 4) for k, v in result.items()}, "rule": rule["rule"]}


def make(design, key, path):
    """The report as a dictionary; power and proofs are added when they are asked for."""
    listed, of_path = blocks(design)
    whole = listed[0]
    library, clock = design.library, design.clock_ns
    start, end, steps = path
    slack = design.endpoints[0].slack
    stages = [b for b in listed[1:] if b["delay_ns"] and b["flip_flops"]]
    median = statistics.median(b["delay_ns"] for b in stages)
    slow = sorted((b for b in stages if b["delay_ns"] > median * SLOW_STAGE), key=lambda b: -b["delay_ns"])
    allowed = clock - slack
    report = {
        "schema": SCHEMA,
        "key": key,
        "config": design.options.title,
        "parameters": design.parameters,
        "library": {
            "name": library.name,
            "liberty": library.path,
            "nand2": library.nand2,
            "nand2_um2": library.nand2_area,
            "fo4_ns": round(design.fo4_ns, 5),
            "wire_load": library.wire_load,
            "setup": f"{library.name}.json" if library.setup else "",
        },
        "tools": {**mapping.versions(), "opensta": timing.version()},
        "memories": design.options.memories,
        "area": {
            "logic_um2": whole["logic_um2"],
            "memory_um2": whole["memory_um2"],
            "total_um2": round(whole["logic_um2"] + whole["memory_um2"], 1),
            "logic_kge": whole["logic_kge"],
            "clocked_kge": round(library.kge(whole["clocked_um2"]), 3),
            "memory_kge": whole["memory_kge"],
            "total_kge": round(whole["logic_kge"] + whole["memory_kge"], 3),
            "flip_flops": whole["flip_flops"],
            "memory_bits": whole["memory_bits"],
            "cells": whole["cells"],
            "fan_out_buffers": sum(design.buffers.get(design.kinds[i].name, 0) for _, i in design.netlist.instances()),
        },
        "timing": {
            "clock_ns": clock,
            "slack_ns": slack,
            "allowed_ns": round(allowed, 4),
            "allowed_fo4": round(allowed / design.fo4_ns, 1),
            "mhz": round(1000 / allowed, 1),
            "from": start,
            "to": end,
            "from_block": block_of(design, of_path, start + "/x"),
            "to_block": block_of(design, of_path, end + "/x"),
            "steps": [
                {"pin": p, "cell": c, "delay_ns": d, "at_ns": t, "block": block_of(design, of_path, p)}
                for p, c, d, t in steps
            ],
            "median_delay_ns": round(median, 4),
            "slow_stages": [
                {
                    "block": b["block"],
                    "delay_ns": b["delay_ns"],
                    "delay_fo4": round(b["delay_ns"] / design.fo4_ns, 1),
                    "of_median": round(b["delay_ns"] / median, 2),
                    "endpoint": b["endpoint"],
                }
                for b in slow
            ],
            "efforts": {design.kinds[i].name: effort for i, effort in sorted(design.efforts.items())},
        },
        "forty_nm": {
            **forty_nm(design, whole["logic_um2"]),
            **({} if design.options.units else {"thesis_4w4c_mm2": THESIS_MM2}),
        },
        "lanes": lanes(design, listed),
        "blocks": listed,
        "power": None,
        "proofs": None,
    }
    return report


def lanes(design, listed):
    """kGE of one lane, flip-flops included, and its goal."""
    result = {}
    for base, label, goals in GOALS:
        rows = [b for b in listed if b["block"].endswith("/" + base)]
        if not rows:
            continue
        goal = next((g for wanted, g in goals if wanted.items() <= design.parameters.items()), None)
        result[label] = {
            "kge": round(sum(r["logic_kge"] for r in rows) / sum(r["instances"] for r in rows), 2),
            "goal_kge": goal,
        }
    return result


NEEDED = {
    "area": ["logic_um2", "logic_kge", "clocked_kge", "memory_bits", "flip_flops"],
    "timing": ["slack_ns", "allowed_fo4", "to_block", "steps"],
    "forty_nm": ["total_mm2", "total_mm2_low", "total_mm2_high"],
    "library": ["fo4_ns", "nand2_um2", "wire_load"],
    "tools": ["yosys", "opensta"],
}


def check(report):
    """The report's own promises, for the tests: raises what is broken."""
    for group, names in NEEDED.items():
        for name in names:
            if name not in report.get(group, {}):
                raise SynthError(f"the report has no {group}.{name}")
    whole = report["blocks"][0]
    top = [b for b in report["blocks"][1:] if "/" not in b["block"]]
    for what in ("logic_um2", "memory_um2"):
        parts = sum(b[what] for b in top) + (whole["own_um2"] if what == "logic_um2" else 0)
        if abs(parts - whole[what]) > 1 + 1e-6 * whole[what]:
            raise SynthError(f"the blocks' {what} add up to {parts:.1f}, not to {whole[what]:.1f}")


def load_run(path, config, units=0):
    """A run's report, which must be of the configuration of that name; of a chip of so many units, with its
    traverser inside.
    """
    try:
        with open(path, encoding="utf-8") as file:
            run = json.load(file)
    except (OSError, ValueError) as error:
        raise SynthError(f"RUN={path}: not a report of raypool sim ({error})") from error
    if not isinstance(run, dict) or "mrays_per_second" not in run:
        raise SynthError(f"RUN={path}: not a report of raypool sim (it has no mrays_per_second)")
    if run.get("config") != config:
        raise SynthError(f"RUN={path}: drawn with configuration {run.get('config')}, but this is {config}")
    if units and run.get("units") != units:
        raise SynthError(f"RUN={path}: drawn by a chip of {run.get('units')} units, but this one has {units}")
    if units and run.get("traverser") != "hardware":
        raise SynthError(
            f"RUN={path}: drawn with traverser {run.get('traverser')}, which has no known area; draw it with "
            "TRAVERSER=hardware"
        )
    return run


def efficiency(report, path, run, whole_chip=False):
    """Mrays/s of a run at the simulated chip's clock and at the one that the library allows; a mm2 and a kGE of the
    whole chip, or of its units.
    """
    units = run.get("units", 1)
    rate = run["mrays_per_second"]
    areas = 1 if whole_chip else units
    return {
        "run": path,
        "mrays_per_second": rate,
        "mrays_per_second_allowed": rate * report["timing"]["mhz"] / SIMULATED_MHZ,
        "units": units,
        "whole_chip": whole_chip,
        "mrays_per_second_mm2": rate / areas / report["forty_nm"]["total_mm2"],
        "mrays_per_second_kge": rate / areas / report["area"]["total_kge"],
    }


def lane_line(label, lane):
    """The size of a lane, and whether it reaches its goal, which is not about the clock."""
    text = f"{label:8} {lane['kge']:.2f} kGE"
    if not lane["goal_kge"]:
        return text
    return f"{text}, goal at most {lane['goal_kge']:g}: {'met' if lane['kge'] <= lane['goal_kge'] else 'missed'}"


def number(value, places=2):
    return "-" if value is None else f"{value:.{places}f}"


def proofs_line(verdicts):
    rest = [f"{name} {verdict}" for name, verdict in sorted(verdicts.items()) if verdict != "proved"]
    return f"proofs   {len(verdicts) - len(rest)} of {len(verdicts)} kinds of block proved equal to their RTL" + (
        f"; not: {'; '.join(rest)}" if rest else ""
    )


def power_lines(power, chip):
    """Of a unit its largest blocks; of a chip a table by place, as that of areas, in mW."""
    text = f"power    {power['total_w'] * 1000:.0f} mW at {1000 / power['clock_ns']:.0f} MHz while drawing "
    text += f"({power['kernel']}"
    if not chip:
        largest = sorted(power["blocks"], key=lambda r: -r["total_w"])[:6]
        return [text + "); the largest: " + ", ".join(f"{r['block']} {r['total_w'] * 1000:.1f}" for r in largest)]
    told = [p for p in power["places"] if p["total_w"] >= 0.0005 * power["total_w"] or "/" not in p["block"]]
    names = ["  " * place["block"].count("/") + place["block"] for place in told]
    width = max(map(len, names))
    head = f"         {'mW':{width}} {'n':>4} {'internal':>9} {'switching':>9} {'leakage':>9} {'memory':>9} {'all':>9} "
    lines = [text + f", {power['cycles']} cycles)", head + f"{'activity':>8}"]
    for name, place in zip(names, told):
        watts = [place[f"{what}_w"] for what in ("internal", "switching", "leakage", "memory", "total")]
        numbers = " ".join(f"{1000 * w:>9.2f}" if w else f"{'-':>9}" for w in watts)
        lines.append(f"         {name:{width}} {place['instances']:>4} {numbers} {place['activity']:>8.4f}")
    return lines


def table(report, against=None):
    """What is printed: blocks of the first two levels that are not tiny; of a chip all of the first, and its units'."""
    area, when, scaled = report["area"], report["timing"], report["forty_nm"]
    cells = report["library"]
    wires = f" with its wire load {cells['wire_load']}" if cells["wire_load"] else ""
    lines = [
        f"{report['config']}  {cells['name']}, FO4 {cells['fo4_ns'] * 1000:.1f} ps{wires}, yosys "
        f"{report['tools']['yosys']}, OpenSTA {report['tools']['opensta']}",
        "",
    ]
    old = {b["block"]: b for b in against["blocks"]} if against else {}
    chip = report["blocks"][0]["block"] == "chip"
    listed = []
    for block in report["blocks"]:
        tiny = block["logic_um2"] + block["memory_um2"] < 0.0005 * area["total_um2"]
        level = block["block"].count("/")
        if level < (3 if chip else 2) and (not tiny or chip and level == 0):
            listed.append(("  " * level + block["block"], block))
    width = max(44, *(len(name) for name, _ in listed))
    head = f"{'block':{width}} {'n':>4} {'um2':>11} {'kGE':>9} {'memory kGE':>11} "
    head += f"{'flip-flops':>11} {'memory bits':>12} {'slack ns':>9}"
    lines.append(head + (f" {'kGE before':>11} {'change':>8}" if against else ""))
    for name, block in listed:
        line = (
            f"{name:{width}} {block['instances']:>4} {block['logic_um2']:>11.0f} "
            f"{block['logic_kge']:>9.2f} "
            f"{number(block['memory_kge']) if block['memory_bits'] else '-':>11} {block['flip_flops']:>11} "
            f"{block['memory_bits'] or '-':>12} {number(block['slack_ns'], 3):>9}"
        )
        if against:
            before = old.get(block["block"])
            line += f" {number(before['logic_kge']) if before else '-':>11} "
            if before and before["logic_kge"]:
                line += f"{100 * (block['logic_kge'] / before['logic_kge'] - 1):>+7.1f}%"
            else:
                line += f"{'-' if before else 'new':>8}"
        lines.append(line)
    lines += [
        "",
        f"area     {area['logic_kge']:.1f} kGE logic, {area['memory_kge']:.1f} kGE memory ({area['memory_bits']} bits, "
        f"{report['memories']}), {area['flip_flops']} flip-flops, {area['cells']} cells",
        f"gates    {area['logic_kge'] - area['clocked_kge']:.1f} kGE combinational, {area['clocked_kge']:.1f} kGE "
        "flip-flops and clock gates",
        f"40 nm    {scaled['total_mm2']:.3f} mm2 ({scaled['total_mm2_low']:.3f} to {scaled['total_mm2_high']:.3f}): "
        f"logic {scaled['logic_mm2']:.3f}, memory {scaled['memory_mm2']:.3f}"
        + (f"; the thesis' 4w4c: {scaled['thesis_4w4c_mm2']}" if "thesis_4w4c_mm2" in scaled else ""),
        f"timing   slack {when['slack_ns']:+.3f} ns at {when['clock_ns']:g} ns: {when['mhz']:.0f} MHz, "
        f"{when['allowed_ns']:.2f} ns, {when['allowed_fo4']:.1f} FO4",
        f"slowest  from {when['from_block']} ({when['from']}) to {when['to_block']} ({when['to']})",
    ]
    missed = [b for b in report["blocks"] if b["slack_ns"] is not None and b["slack_ns"] < 0]
    late = ", ".join(f"{b['block']} {b['slack_ns']:+.3f}" for b in missed)
    lines.append(f"missed   the clock: {late or 'no block'}")
    lines.append(
        f"stages   median of the blocks' slowest paths {when['median_delay_ns']:.2f} ns; more than a third slower: "
        f"{len(when['slow_stages']) or 'none'}"
    )
    lines += [
        f"         {b['delay_ns']:.2f} ns, {b['delay_fo4']:.1f} FO4, {b['of_median']:.2f} of the median: {b['block']}, "
        f"into {b['endpoint']}"
        for b in when["slow_stages"]
    ]
    lines += [lane_line(label, lane) for label, lane in report["lanes"].items()]
    if report.get("power"):
        lines += power_lines(report["power"], chip)
    if report.get("proofs"):
        lines.append(proofs_line(report["proofs"]))
    if report.get("efficiency"):
        e = report["efficiency"]
        lines.append(
            f"speed    {e['mrays_per_second']:.2f} Mrays/s: {e['mrays_per_second_mm2']:.1f} a mm2 at 40 nm, "
            f"{e['mrays_per_second_kge']:.4f} a kGE (memories counted)"
        )
        lines.append(
            f"clock    {e['mrays_per_second_allowed']:.2f} Mrays/s at the {when['mhz']:.0f} MHz that "
            f"{report['library']['name']} allows, {e['mrays_per_second']:.2f} at {SIMULATED_MHZ} MHz"
        )
        lines += published() if e["whole_chip"] else []
    if against:
        lines.append(
            f"against  {against['config']} ({against['area']['total_kge']:.1f} kGE, {against['timing']['mhz']:.0f} MHz)"
        )
    return "\n".join(lines)


def load(path):
    try:
        with open(path, encoding="utf-8") as file:
            report = json.load(file)
    except (OSError, ValueError) as error:
        raise SynthError(f"{path}: not a synthesis report ({error})") from error
    schema = report.get("schema") if isinstance(report, dict) else None
    if schema != SCHEMA:
        raise SynthError(f"{path}: not a synthesis report (schema {schema}, wanted {SCHEMA})")
    return report
