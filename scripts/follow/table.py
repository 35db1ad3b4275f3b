"""What is printed of a journey, line by line."""
from . import packages
from .check import query
from .walk import INSIDE

QUIET = ("arguments", "instructions", "tree")  # stations that are shown only when they are asked for


def arguments_lines(words):
    """What the host has written for the kernels, before the frame."""
    names = [("eye", 0, 3), ("corner", 3, 3), ("step_x", 6, 3), ("step_y", 9, 3), ("light", 12, 3),
             ("light's colour", 15, 3), ("offset", 18, 1)]  # fmt: skip
    for name, first, count in names:
        values = [packages.to_float(words[first + at]) for at in range(count)]
        yield f"  {first:>2} {name:<15} {packages.text(values)}"
    for name, first in (("log2 of a tile's width", 19), ("width - 1", 20), ("picture's width", 21), ("height", 22)):
        yield f"  {first:>2} {name:<15} {words[first]}"


def tree_lines(tree, life):
    """The boxes and triangles that this ray is tested against on its way through the tree."""
    shadow = packages.is_shadow(life.words)
    hit, steps = tree.walk(*query(life.words), any_hit=shadow)
    for kind, what, tests in steps:
        if kind == "node":
            yield f"  node {what}: {len(tests)} boxes"
            for child, begin, end in tests:
                low, high = packages.text(child.lower), packages.text(child.upper)
                found = f"met from t {begin:.6g} to {end:.6g}" if begin <= end else "missed"
                yield f"    {child.name():<10} {low} .. {high}: {found}"
        elif kind == "leaf":
            yield f"  {what.name()}:"
            for triangle, test in tests:
                found = f"hit at t {test.t:.6g}, u {test.u:.6g}, v {test.v:.6g}" if test else "missed"
                yield f"    triangle {triangle.number}: {found}"
        else:
            yield f"  {what.name()}: begins at t {tests:.6g}, behind the hit, and is left out"
    found = "in the way" if shadow else "nearest"
    yield f"  {found}: triangle {hit.triangle} at t {hit.t:.6g}" if hit else "  nothing is hit"


def shown(options, name, station):
    if options.stations:
        return station in options.stations and (not options.rays or name in options.rays)
    return station not in QUIET and (not options.rays or name in options.rays)


def title_of(life):
    fates = {"hit": "hits something", "missed": "hits nothing", "free": "reaches the light",
             "blocked": "does not reach the light", "dropped": "is dropped"}  # fmt: skip
    return f"{life.name}: the {packages.full_name(life.words)} {fates[life.fate]}"


def journey_lines(options, frame, chip, journey, tree):
    if not options.stations and not options.rays:
        width, height = frame.size
        x, y = options.pixel
        scene, units = frame.report["scene"], f"{chip.units} unit{'s' if chip.units > 1 else ''}"
        config, lanes = frame.report["config"].split("+")[0], chip.wave.constant(INSIDE + "LANES")
        yield (f"pixel {x},{y} of {scene['name']}, {scene['triangles']} triangles, {width}x{height}, depth "
               f"{frame.report['depth']}: rtl/chip/rp_chip.v, {units} of {config}, "
               f"{lanes} lanes of traverser")  # fmt: skip
        yield (f"the frame takes {chip.wave.cycles} cycles, {len(chip.launches)} launches and "
               f"{len(chip.exports)} rays, {len(journey.lives)} of them of this pixel")  # fmt: skip
    if "arguments" in options.stations:
        yield "arguments, as the host has written them:"
        yield from arguments_lines(chip.arguments)
    for life in journey.lives.values():
        steps = [step for step in life.steps if shown(options, life.name, step.station)]
        walk = shown(options, life.name, "tree") and life.fate != "dropped"
        if not steps and not walk:
            continue
        if not options.stations:
            yield ""
        yield title_of(life)
        for step in steps:
            yield f"  {step.cycle:>8}  {step.way + ': ' if step.way else ''}{step.what}"
            yield from (f"              {detail}" for detail in step.details)
        if walk:
            yield from tree_lines(tree, life)


def check_lines(options, check):
    if options.stations or options.rays:
        if "host" not in options.stations:
            return
    else:
        yield ""
    yield "beside the host's computation:"
    yield from (f"  {line}" for line in check.lines)


def last_lines(options, frame, journey, check, wrong, names):
    if options.stations or options.rays:
        return
    yield ""
    yield (f"in the waveform {journey.compared} packages stand twice, and {len(check.lines)} values are computed "
           f"again: {len(wrong)} differ")  # fmt: skip
    yield f"pictures: {frame.out}: {', '.join(names)}"
