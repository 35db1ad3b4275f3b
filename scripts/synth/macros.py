"""Memory macros of one port by their own Liberty files: size, area, access and set-up time of each."""
import glob
import os
from dataclasses import dataclass

from . import liberty
from .errors import SynthError
from .library import text_of

# A memory is a macro where one is wide and deep enough and this share of its bits is used; else it is priced by
# constraints/memories.json.
USED_SHARE = 0.5


@dataclass
class Macro:
    """Times in ns, area in um2."""

    name: str
    depth: int
    width: int
    area: float
    access_ns: float
    setup_ns: float


def middle(group):
    """The value in the middle of a table, which is for a usual slope and load."""
    rows = [[float(word) for word in row.split(",")] for row in group.attributes.get("values", [])]
    return rows[len(rows) // 2][len(rows[len(rows) // 2]) // 2] if rows else 0.0


def below(group):
    """A group and all groups in it."""
    yield group
    for inner in group.groups:
        yield from below(inner)


def times(cell, tables, wanted):
    """Of every timing of a cell that is `wanted`, the values of these tables."""
    return [
        middle(table)
        for group in below(cell)
        if group.kind == "timing" and wanted(group)
        for kind in tables
        for table in group.all(kind)
    ]


def macro_of(cell, path):
    memory = cell.all("memory")[0]
    output = next((b for b in cell.all("bus") if b.attributes.get("direction") == "output"), None)
    reads = output.all("timing") if output else []
    if not reads:
        raise SynthError(f"MEMORIES: {path}: {cell.arguments[0]} has no timing of its output")
    clock = reads[0].attributes["related_pin"]

    def sets_up(timing):
        return timing.attributes.get("timing_type") == "setup_rising" and timing.attributes.get("related_pin") == clock

    return Macro(
        name=cell.arguments[0],
        depth=2 ** int(memory.number("address_width")),
        width=int(memory.number("word_width")),
        area=cell.number("area"),
        access_ns=max(times(output, ("cell_rise", "cell_fall"), lambda timing: True)),
        setup_ns=max([0.0, *times(cell, ("rise_constraint", "fall_constraint"), sets_up)]),
    )


def read(folder):
    """The macros in the Liberty files of a folder."""
    found = []
    for path in sorted(glob.glob(os.path.join(folder, "*.lib")) + glob.glob(os.path.join(folder, "*.lib.gz"))):
        library = liberty.parse(text_of(path), path)
        if library.attributes.get("time_unit", "1ns") != "1ns":
            raise SynthError(f"MEMORIES: {path}: times in {library.attributes['time_unit']}, where 1ns is read")
        found += [macro_of(cell, path) for cell in library.all("cell") if cell.all("memory")]
    if not found:
        raise SynthError(f"MEMORIES={folder}: no Liberty file (*.lib, *.lib.gz) of a memory macro there")
    return found


def fitting(macros, width, depth):
    """The smallest macro for a memory, or None."""
    large = [m for m in macros if m.width >= width and m.depth >= depth]
    used = [m for m in large if width * depth >= USED_SHARE * m.width * m.depth]
    return min(used, key=lambda m: m.area, default=None)
