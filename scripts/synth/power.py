"""Power by block: the toggles of the simulated netlist, averaged over each first-level block (of a chip's units and
traverser over each block in them), given to OpenSTA.
"""
import json
import math
import os
import re
from collections import defaultdict
from dataclasses import dataclass

from . import replay, report, timing
from .errors import SynthError

KERNEL = ["sim", "room", "--size", "8x8", "--depth", "1"]
# What only holds other blocks together: those in it have an activity of their own each.
OPENED = ("multiprocessor", "compute_unit", "traverser")
# The cells of one block, or of all below it too, added up in OpenSTA: its own report has a line for each cell, and to
# find those of a block it looks through all.
WALK = """proc add_power {instance deep} {
  set sum [list 0 0.0 0.0 0.0]
  set iterator [sta::Instance_child_iterator $instance]
  while {[$iterator has_next]} {
    set child [$iterator next]
    if {[sta::Instance_is_leaf $child]} {
      set more [concat 1 [sta::instance_power $child [sta::cmd_corner]]]
    } elseif {$deep} {
      set more [add_power $child 1]
    } else {
      continue
    }
    set added {}
    foreach a $sum b [lrange $more 0 3] { lappend added [expr {$a + $b}] }
    set sum $added
  }
  $iterator finish
  return $sum
}
"""
_SUM = re.compile(r"^== (?P<path>\S*) (?P<cells>\d+) (?P<watts>\S+ \S+ \S+)$", re.M)


def measure(design, folder):
    """Simulates the netlist on a small picture. Returns toggles and nets by instance path, accesses of memories,
    cycles.
    """
    library = replay.build(design, folder, count=True)
    passed, text = replay.lockstep(design, library, folder, KERNEL, engine="rtl")
    if not passed:
        raise SynthError(
            "the netlist did not draw the frame that is needed to measure its activity"
            + (f" as the model does:\n{text.strip()}" if design.options.units else "")
        )
    toggles, accesses, cycles = {}, {}, 0
    for line in text.splitlines():
        words = (line + " ").split(" ")  # the top itself has no path
        if words[0] == "TOGGLES":
            toggles[words[4]] = (int(words[1]), int(words[3]))
            cycles = int(words[2])
        elif words[0] == "ACCESSES":
            accesses[words[2]] = int(words[1])
    if design.options.units:
        # A chip is also clocked before the frame, and a while after it.
        with open(os.path.join(folder, "picture", "report.json"), encoding="utf-8") as file:
            cycles = json.load(file)["cycles"]
    if not toggles or not cycles:
        raise SynthError(f"the simulated netlist counted no toggles; see {folder}/sim.log")
    return toggles, accesses, cycles


@dataclass
class Part:
    """A block with one activity for its cells: all below it too, or its own gates alone."""

    path: tuple
    identity: str
    deep: bool
    toggles: int = 0
    nets: int = 0
    picojoules: float = 0.0  # of accesses to its memories

    @property
    def name(self):
        return "/".join(self.path)

    @property
    def used(self):
        return self.nets or self.picojoules

    def activity(self, cycles):
        """Toggles a cycle and gate."""
        return self.toggles / (self.nets * cycles) if self.nets else 0.0


def parts(design):
    """The first-level blocks, and in their place what lies in those that are opened; by path."""
    modules, found = design.netlist.modules, {}

    def visit(identity, path):
        found[path] = Part(path, identity, False)
        for name, (child, _) in modules[identity].blocks.items():
            below = path + (name,)
            if child in modules and design.kinds[child].base in OPENED:
                visit(child, below)
            else:
                found[below] = Part(below, child, True)

    visit(design.netlist.top, ())
    return found


def part_of(found, path):
    """The part that has a block."""
    words = tuple(path.split("/")) if path else ()
    while words not in found:
        words = words[:-1]
    return found[words]


def memory_energy_pj(design, kind):
    """One access, scaled from the reference: capacitance with the square root of the area of a gate,
    and the voltage squared.
    """
    voltage = float(design.library.group.attributes.get("nom_voltage", 1.1))
    return design.memory.energy_pj(kind) * math.sqrt(design.memory.scale) * (voltage / 1.1) ** 2


def cell_power(design, listed, cycles, folder):
    """Internal, switching and leakage power of each part's cells, by its name, as OpenSTA has it."""
    script = timing.set_up(design.verilog, design.library, design.macros, design.clock_ns, design.top) + WALK
    for part in listed:
        rate = part.activity(cycles)
        script += f"set_power_activity -global -activity {rate:.6f}\nset_power_activity -input -activity {rate:.6f}\n"
        block = f"[sta::find_instance {{{part.name}}}]" if part.path else "[sta::top_instance]"
        script += f'puts "== {part.name} [add_power {block} {int(part.deep)}]"\n'
    found = {}
    for line in _SUM.finditer(timing.run_sta(script, folder, "power")):
        # OpenSTA counts the energy of a rising and a falling edge for every toggle.
        internal, switching, leakage = (float(w) for w in line["watts"].split())
        if int(line["cells"]):
            found[line["path"]] = (internal / 2, switching, leakage)
    return found


def estimate(design):
    """Watt by block: `blocks` has each once, `places` all instances of a place of the hierarchy together, with all that
    lies below.
    """
    folder = os.path.join(design.folder, "power")
    toggles, accesses, cycles = measure(design, folder)
    kinds = dict(design.netlist.instances())
    found = parts(design)
    for path, (count, nets) in toggles.items():
        part = part_of(found, path)
        part.toggles += count
        part.nets += nets
    for path, count in accesses.items():
        energy = memory_energy_pj(design, design.kinds[kinds[tuple(path.split("/"))]])
        part_of(found, path).picojoules += count * energy
    shares = []
    of_cells = cell_power(design, [p for p in found.values() if p.nets], cycles, folder)
    seconds = cycles * design.clock_ns * 1e-9
    for part in found.values():
        if part.nets and part.name not in of_cells:
            raise SynthError(f"OpenSTA gave no power of {part.name or design.top}; see {folder}/power.log")
        internal, switching, leakage = of_cells.get(part.name, (0.0, 0.0, 0.0))
        memory = part.picojoules * 1e-12 / seconds
        watts = {"internal_w": internal, "switching_w": switching, "leakage_w": leakage, "memory_w": memory}
        shares.append((part, watts))
    total = sum(sum(watts.values()) for _, watts in shares)
    design.phases.note(f"power over {cycles} cycles of a rendered picture: {total:.3f} W")
    return {
        "kernel": " ".join(KERNEL[:4]),
        "cycles": cycles,
        "clock_ns": design.clock_ns,
        "blocks": [row(part.name or design.top, [(part, watts)], cycles) for part, watts in shares if part.used],
        "places": places(design, shares, cycles),
        "total_w": total,
    }


def row(name, shares, cycles):
    """What the given parts have together: [(part, {what: W})]."""
    nets = sum(part.nets for part, _ in shares)
    watts = {what: sum(of[what] for _, of in shares) for what in shares[0][1]}
    return {
        "block": name,
        "activity": sum(part.toggles for part, _ in shares) / (nets * cycles) if nets else 0.0,
        **watts,
        "total_w": sum(watts.values()),
    }


def places(design, shares, cycles):
    """One row for each place of the hierarchy down to the parts, all that lies in it counted: the report's blocks."""
    inside, instances = defaultdict(list), defaultdict(set)
    for part, watts in shares:
        for depth in range(len(part.path) + 1):
            name = report.base_path(design, part.path[:depth]) or design.top
            inside[name].append((part, watts))
            instances[name].add(part.path[:depth])
    rows = [{**row(name, listed, cycles), "instances": len(instances[name])} for name, listed in inside.items()]
    level = {design.top: -1}
    return sorted(rows, key=lambda r: (level.get(r["block"], r["block"].count("/")), -r["total_w"]))
