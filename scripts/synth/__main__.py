"""python3 -m synth COMMAND, with scripts/ as the folder of modules. The Makefile's targets call it."""
import argparse
import json
import os
import shutil
import sys
import time

from . import areas, elaborate, fit, flow, growth, module, pictures, power, prove, replay, report, timing
from .errors import SynthError, say, warn
from .phases import Phases


def config_of(arguments):
    folder = os.path.join(flow.BUILD, "configurations")
    return elaborate.with_fields(arguments.config, arguments.set, folder) if arguments.set else arguments.config


def units_of(arguments):
    """Of the chip; 0: a unit alone."""
    if not getattr(arguments, "chip", False):
        return 0
    if arguments.units not in ("1", "2", "4"):
        raise SynthError(f"CUS={arguments.units}: a chip has 1, 2 or 4 compute units")
    return int(arguments.units)


def rounds_of(arguments):
    rounds = getattr(arguments, "rounds", None)
    if not rounds:
        return flow.CLOSURE_ROUNDS
    if rounds not in map(str, range(flow.MOST_ROUNDS + 1)):
        raise SynthError(f"ROUNDS={rounds}: 0 to {flow.MOST_ROUNDS}")
    return int(rounds)


def options_of(arguments):
    try:
        clock = float(arguments.clock) if arguments.clock else None
    except ValueError:
        clock = 0.0
    if clock is not None and not 0.0 < clock < 1e6:
        raise SynthError(f"CLOCK={arguments.clock}: the period in ns")
    return flow.Options(
        config=config_of(arguments),
        liberty=arguments.liberty or None,
        clock_ns=clock,
        memories=arguments.memories or "macros",
        jobs=arguments.jobs,
        units=units_of(arguments),
        rounds=rounds_of(arguments),
    )


def store(result, path):
    with open(path + ".new", "w", encoding="utf-8") as file:
        json.dump(result, file, indent=1)
    os.rename(path + ".new", path)


# Phases that add to a report what it is asked for: what each does.
ADDED = {
    "power": "simulate the netlist, then estimate its power",
    "proofs": "prove each kind of block equal to its RTL",
}


def made_report(options, wanted):
    """The design and its report, made or kept; `wanted`: names of what is added to it, power or proofs."""
    design = flow.open_design(options)
    path = os.path.join(design.folder, "report.json")
    key = flow.digest(design)
    begin = time.time()
    result = kept_report(path, key)
    extra = {name: does for name, does in ADDED.items() if name in wanted and not (result and result[name])}
    if result is None:
        design.phases = Phases({**flow.phases_of(options), **extra}, design.folder)
        flow.synthesise(design)
        design.phases.begin("report")
        worst = timing.describe(
            [design.endpoints[0].pin],
            design.verilog,
            design.library,
            design.macros,
            design.clock_ns,
            os.path.join(design.folder, "work"),
            design.top,
        )[0]
        result = report.make(design, key, worst)
        result["seconds"] = round(time.time() - begin, 1)
        report.check(result)
        store(result, path)
        pictures.area_bars(result, os.path.join(design.folder, "area.png"))
    for name, estimate in (("power", power.estimate), ("proofs", prove.prove)):
        if name in extra:
            if design.netlist is None:
                map_as_kept(design, result, extra)
            design.phases.begin(name)
            result[name] = estimate(design)
            store(result, path)
    design.phases.end()
    return design, result


def synth_command(arguments):
    against = report.load(arguments.against) if arguments.against else None
    options = options_of(arguments)
    run = report.load_run(arguments.run, options.name, options.units) if arguments.run else None
    begin = time.time()
    wanted = [name for name, given in (("power", arguments.power), ("proofs", arguments.prove)) if given]
    design, result = made_report(options, wanted)
    if run:
        result["efficiency"] = report.efficiency(result, arguments.run, run, bool(options.units))
    say(report.table(result, against))
    if arguments.out:
        os.makedirs(arguments.out, exist_ok=True)
        for name in ("report.json", "area.png", "netlist.v"):
            shutil.copy(os.path.join(design.folder, name), arguments.out)
        if arguments.run:
            with open(os.path.join(arguments.out, "report.json"), "w", encoding="utf-8") as file:
                json.dump(result, file, indent=1)
    say(
        f"report   {arguments.out or design.folder}/report.json, area.png, netlist.v"
        + (f" ({result['seconds']:.0f} s)" if time.time() - begin > 5 else " (kept)")
    )


def kept_report(path, key):
    """The report of an earlier call, or None where anything that it depends on has changed."""
    try:
        kept = report.load(path)
    except SynthError:
        return None
    return kept if kept["key"] == key else None


def map_as_kept(design, kept, then):
    """The netlist of a kept report (None: one that was not timed); `then`: the phases that follow, what each does."""
    first = {name: does for name, does in flow.phases_of(design.options).items() if name in ("elaborate", "map")}
    design.phases = Phases({**first, **then}, design.folder)
    flow.prepare(design)
    design.phases.begin("map")
    efforts = kept["timing"]["efforts"] if kept else {}
    design.efforts = {k.identity: efforts[k.name] for k in design.kinds.values() if k.name in efforts}
    flow.map_design(design)


def netlist_of(arguments, name, does):
    """The netlist that is kept or mapped, for a phase of this name that begins then."""
    design = flow.open_design(options_of(arguments))
    map_as_kept(design, kept_report(os.path.join(design.folder, "report.json"), flow.digest(design)), {name: does})
    design.phases.begin(name)
    return design


def replay_command(arguments):
    design = netlist_of(arguments, "replay", "run the netlist in lockstep with the model")
    replay.replay(design, arguments.break_number)
    design.phases.end()


def prove_command(arguments):
    only = set(arguments.only.split(",")) if arguments.only else None
    design = flow.open_design(options_of(arguments))
    if only:
        flow.prepare(design)
        known = {k.base for k in design.kinds.values() if not k.memory}
        if not only <= known:
            raise SynthError(
                f"ONLY={arguments.only}: {design.options.title} has no block {', '.join(sorted(only - known))}; "
                f"it has {', '.join(sorted(known))}"
            )
    design = netlist_of(arguments, "proofs", ADDED["proofs"])
    verdicts = prove.prove(design, only)
    design.phases.end()
    say(report.proofs_line(verdicts))
    if any(v == "different" for v in verdicts.values()):
        raise SynthError("a mapped block differs from its RTL")


def areas_command(arguments):
    areas.make(arguments.jobs, arguments.check)


def growth_command(arguments):
    growth.grow(arguments.jobs, arguments.out or os.path.join(flow.BUILD, "growth"), arguments.plan)


def module_command(arguments):
    say(module.table(module.synthesise(arguments.module, arguments.parameters, options_of(arguments))))


def fit_command(arguments):
    fit.fit(arguments.found, arguments.jobs)
    if not arguments.power:
        return
    found = fit.load(arguments.found)
    for title, config in (("before", fit.base_config(found)), ("fitted", found["file"])):
        arguments.config, arguments.set = config, None
        result = made_report(options_of(arguments), ["power"])[1]
        say(fit.with_power(title, result))


def parser():
    top = argparse.ArgumentParser(prog="synth", description="area, timing and power of the unit, or of the chip")
    commands = top.add_subparsers(dest="command", required=True)
    for name, function in (
        ("report", synth_command),
        ("replay", replay_command),
        ("prove", prove_command),
        ("growth", growth_command),
        ("areas", areas_command),
        ("fit", fit_command),
        ("module", module_command),
    ):
        command = commands.add_parser(name)
        command.set_defaults(function=function)
        command.add_argument("--config", default="8w8c", help="as in raypool: a name, NwMc, or a JSON file")
        command.add_argument("--set", action="append", metavar="FIELD=VALUE", help="change fields of it, as in raypool")
        command.add_argument("--liberty", help="Liberty file of other cells; a set-up's name: where it is")
        command.add_argument("--clock", help="ns; default from the library's set-up")
        command.add_argument("--memories", help="macros (default), flops, or a folder of macros' Liberty files")
        command.add_argument("--jobs", type=int, default=os.cpu_count() or 2)
        command.add_argument("--out", help="folder for the results")
        if name in ("report", "fit"):
            command.add_argument(
                "--power", action="store_true", help="simulate the netlist and estimate power by block"
            )
        if name == "fit":
            command.add_argument("found", help="what raypool fit --json has written")
        if name == "module":
            command.add_argument("module", help="of rtl/")
            command.add_argument("parameters", nargs="*", help="of one row of the table each: BITS=8 or A=1,B=2")
        if name in ("report", "replay", "prove"):
            command.add_argument("--chip", action="store_true", help="the whole chip")
            command.add_argument("--units", default="1", help="with --chip: compute units, 1, 2 or 4")
        if name == "report":
            command.add_argument("--rounds", help="for speed, at most; with any but 4 no area is won back")
            command.add_argument("--against", help="an earlier report.json to compare with")
            command.add_argument("--run", help="report.json of raypool sim with this configuration: Mrays/s a mm2")
            command.add_argument("--prove", action="store_true", help="prove blocks equal to their RTL")
        if name == "replay":
            command.add_argument(
                "--break", dest="break_number", type=int, default=0, help="swap a cell first: must be detected"
            )
        if name == "areas":
            command.add_argument("--check", action="store_true", help="designs that are not in the table, beside it")
        if name == "growth":
            command.add_argument("--plan", help="what to synthesise, instead of constraints/growth.json")
        if name == "prove":
            command.add_argument("--only", help="modules, with commas between")
    return top


def main():
    arguments = parser().parse_args()
    try:
        arguments.function(arguments)
    except SynthError as error:
        warn(f"synth: {error}")
        return 1
    except KeyboardInterrupt:
        warn("synth: interrupted; what was mapped is kept")
        return 130
    return 0


if __name__ == "__main__":
    sys.exit(main())
