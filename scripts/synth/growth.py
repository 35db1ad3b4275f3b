"""Synthesises sets of configurations (growth.json): area against one parameter, and what single changes cost."""
import json
import os

from . import flow, pictures, report
from .errors import SynthError, say
from .library import ROOT


def merged(base, change):
    result = dict(base)
    for key, value in change.items():
        result[key] = merged(result.get(key, {}), value) if isinstance(value, dict) else value
    return result


def named(change):
    """A file name for a configuration: its values in a row."""
    parts = []
    for key, value in sorted(change.items()):
        if key != "name":
            parts.append(f"{key}_{named(value)}" if isinstance(value, dict) else f"{key}{value}")
    return "-".join(parts)


def area_of(change, jobs, name=None):
    """The report of one configuration, kept; no power, no proofs. `name`: its own, instead of its values in a row."""
    folder = os.path.join(flow.BUILD, "growth")
    os.makedirs(folder, exist_ok=True)
    name = name or named(change)
    path = os.path.join(folder, name + ".json")
    new = f"{path}.{os.getpid()}"
    with open(new, "w", encoding="utf-8") as file:
        json.dump({"name": name, **change}, file)
    os.rename(new, path)
    design = flow.open_design(flow.Options(config=path, jobs=jobs, out=os.path.join(folder, name)))
    key = flow.digest(design)
    kept = os.path.join(design.folder, "area.json")
    if os.path.exists(kept):
        with open(kept, encoding="utf-8") as file:
            found = json.load(file)
        if found["key"] == key:
            return found
    flow.prepare(design)
    flow.map_design(design)
    rows, _ = report.blocks(design)
    whole = rows[0]
    found = {
        "key": key,
        "logic_kge": whole["logic_kge"],
        "memory_kge": whole["memory_kge"],
        "flip_flops": whole["flip_flops"],
        "memory_bits": whole["memory_bits"],
        "mm2": report.forty_nm(design, whole["logic_um2"])["total_mm2"],
    }
    with open(kept, "w", encoding="utf-8") as file:
        json.dump(found, file)
    return found


def grow(jobs, out, plan_path=None):
    plan_path = plan_path or os.path.join(ROOT, "constraints", "growth.json")
    try:
        with open(plan_path, encoding="utf-8") as file:
            plan = json.load(file)
        plan["base"], plan["axes"], plan["steps"]
        for axis in plan["axes"]:
            axis["name"], axis["title"], axis["key"], axis["values"]
        for step in plan["steps"]:
            step["name"], step["to"]
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise SynthError(f"{plan_path}: not a plan like constraints/growth.json ({error})") from error
    os.makedirs(out, exist_ok=True)
    results = {"axes": {}, "steps": []}
    for axis in plan["axes"]:
        rows = []
        for value in axis["values"]:
            change = merged(plan["base"], axis.get("base", {}))
            inner = change
            keys = axis["key"].split(".")
            for key in keys[:-1]:
                inner[key] = dict(inner.get(key, {}))
                inner = inner[key]
            inner[keys[-1]] = value
            found = area_of(change, jobs)
            rows.append((value, found["logic_kge"], found["memory_kge"]))
            say(
                f"growth: {axis['name']} {value}: {found['logic_kge']:.1f} kGE logic, {found['memory_kge']:.1f} kGE "
                f"memory, {found['mm2']:.3f} mm2"
            )
        results["axes"][axis["name"]] = rows
        pictures.growth_lines(
            axis["title"], axis["name"], rows, os.path.join(out, f"growth-{axis['name'].replace(' ', '-')}.png")
        )
    say(f"\n{'step':58} {'logic kGE':>10} {'memory kGE':>11} {'flip-flops':>11} {'mm2 40 nm':>10}")
    for step in plan["steps"]:
        before = area_of(merged(plan["base"], step.get("from", {})), jobs)
        after = area_of(merged(plan["base"], step["to"]), jobs)
        share = step.get("share", 1)
        row = {
            "name": step["name"],
            **{k: (after[k] - before[k]) * share for k in ("logic_kge", "memory_kge", "flip_flops", "mm2")},
        }
        results["steps"].append(row)
        say(
            f"{row['name']:58} {row['logic_kge']:>+10.2f} {row['memory_kge']:>+11.2f} {row['flip_flops']:>+11.0f} "
            f"{row['mm2']:>+10.4f}"
        )
    with open(os.path.join(out, "growth.json"), "w", encoding="utf-8") as file:
        json.dump(results, file, indent=1)
    say(f"growth: {out}/growth.json and growth-*.png")
