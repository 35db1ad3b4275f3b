"""What raypool fit has found, in area: what each change saves alone, and all of them together."""
import hashlib
import json
import os

from . import elaborate, flow
from .errors import SynthError, say
from .growth import area_of

FIGURES = (("logic kGE", "logic_kge", ".1f"), ("memory kGE", "memory_kge", ".1f"), ("memory bits", "memory_bits", "d"),
           ("flip-flops", "flip_flops", "d"))  # fmt: skip


def load(path):
    """The JSON that raypool fit has written."""
    try:
        with open(path, encoding="utf-8") as file:
            found = json.load(file)
        found["base"]["alus"], found["fitted"]["alus"], found["file"], found["config"], found["set"]
        for change in found["changes"]:
            change["field"], change["to"], change["why"]
        return found
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise SynthError(f"{path}: not what raypool fit --json writes ({error})") from error


def unit_of(machine):
    """What of a configuration the Verilog has."""
    return {key: value for key, value in machine.items() if key not in ("name", "chip")}


def changed(machine, field, value):
    """The configuration with the field of this path set."""
    result = json.loads(json.dumps(machine))
    inner = result
    *objects, key = field.split(".")
    for name in objects:
        inner = inner[name]
    inner[key] = value
    return result


def area(machine, jobs):
    """Of the unit, however the machine is called and whatever chip is around it."""
    unit = unit_of(machine)
    name = "fit-" + hashlib.sha256(json.dumps(unit, sort_keys=True).encode()).hexdigest()[:12]
    return area_of(unit, jobs, name)


def row(name, before, after):
    figures = [f"{before[key] - after[key]:>12{form}}" for _, key, form in FIGURES]
    share = 100 * (1 - after["logic_kge"] / before["logic_kge"])
    return f"{name:<26}{''.join(figures)}{share:>11.1f}%"


def fit(path, jobs):
    """Prints the table; returns what it is made from."""
    found = load(path)
    base = area(found["base"], jobs)
    results = {"base": base, "changes": []}
    say(f"{'saved':<26}{''.join(f'{title:>12}' for title, _, _ in FIGURES)}{'of logic':>12}")
    for change in found["changes"]:
        alone = area(changed(found["base"], change["field"], change["to"]), jobs)
        results["changes"].append({"field": change["field"], **alone})
        say(row(change["field"], base, alone))
    results["fitted"] = area(found["fitted"], jobs)
    say(row("all of it", base, results["fitted"]))
    figures = [f"{base[key]:>12{form}}" for _, key, form in FIGURES]
    say(f"{'of the unit without it':<26}{''.join(figures)}")
    return results


def base_config(found):
    """The unit that was fitted, as the other commands name it: their reports of it are used again."""
    words = [word for text in found["set"] for word in text.split()]
    fields = [word for word in words if not word.startswith(("chip.", "name="))]
    folder = os.path.join(flow.BUILD, "configurations")
    return elaborate.with_fields(found["config"], fields, folder) if fields else found["config"]


def with_power(title, report):
    """A line of a timed report that has power."""
    area, timing, power = report["area"], report["timing"], report["power"]
    return (
        f"{title:<8}{area['logic_kge']:>8.1f} kGE logic, {area['memory_bits']} memory bits, slack "
        f"{timing['slack_ns']:+.3f} ns at {timing['clock_ns']:g} ns, {power['total_w'] * 1000:.0f} mW at "
        f"{1000 / power['clock_ns']:.0f} MHz while drawing ({power['kernel']})"
    )
