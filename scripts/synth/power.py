"""Power by block: the toggles of the simulated netlist, averaged over each first-level block, given to OpenSTA."""
import math
import os
import re

from . import replay, timing
from .errors import SynthError, progress

_CELL = re.compile(r"^\s*([\d.eE+-]+)\s+([\d.eE+-]+)\s+([\d.eE+-]+)\s+[\d.eE+-]+ \S+$", re.M)

KERNEL = ["sim", "room", "--size", "8x8", "--depth", "1"]


def measure(design, folder):
    """Simulates the netlist on a small picture. Returns toggles and nets by instance path, accesses of memories,
    cycles.
    """
    library = replay.build(design, folder, count=True)
    passed, text = replay.lockstep(design, library, folder, KERNEL, engine="rtl")
    if not passed:
        raise SynthError("the netlist did not draw the frame whose activity was to be measured")
    toggles, accesses, cycles = {}, {}, 0
    for line in text.splitlines():
        words = (line + " ").split(" ")  # the unit itself has no path
        if words[0] == "TOGGLES":
            toggles[words[4]] = (int(words[1]), int(words[3]))
            cycles = int(words[2])
        elif words[0] == "ACCESSES":
            accesses[words[2]] = int(words[1])
    if not toggles or not cycles:
        raise SynthError(f"the simulated netlist counted no toggles; see {folder}/sim.log")
    return toggles, accesses, cycles


def activity(toggles, cycles, prefix):
    """Toggles a cycle and gate, averaged over the instances at or below a path; of the unit, "", over its own gates."""
    total = nets = 0
    for path, (count, bits) in toggles.items():
        if path == prefix or prefix and path.startswith(prefix + "/"):
            total += count
            nets += bits
    return total / (nets * cycles) if nets else 0.0


def memory_energy_pj(design, kind):
    """One access, scaled from the reference: capacitance with the square root of the area of a gate,
    and the voltage squared.
    """
    voltage = float(design.library.group.attributes.get("nom_voltage", 1.1))
    return design.memory.energy_pj(kind) * math.sqrt(design.memory.scale) * (voltage / 1.1) ** 2


def estimate(design):
    """Watt by first-level block: [{block, activity, internal_w, switching_w, leakage_w, memory_w, total_w}]."""
    folder = os.path.join(design.folder, "power")
    toggles, accesses, cycles = measure(design, folder)
    top = design.netlist.modules[design.netlist.top]
    rates = {name: activity(toggles, cycles, name) for name in ["", *top.blocks]}
    # OpenSTA gives the power of cells, of a block none: the cells of every block at or
    # below a first-level one are listed.
    script = timing.set_up(design.verilog, design.library, design.macros, design.clock_ns, design.top)
    kinds = dict(design.netlist.instances())
    for name, rate in rates.items():
        script += f"set_power_activity -global -activity {rate:.6f}\nset_power_activity -input -activity {rate:.6f}\n"
        script += f'puts "== {name}"\n'
        for path, identity in kinds.items():
            if (
                path[:1] == ((name,) if name else ())
                and identity in design.netlist.modules
                and design.netlist.modules[identity].gates
            ):
                script += f'report_power -instances [get_cells {{{"/".join(path + ("*",))}}}] -digits 6\n'
    text = timing.run_sta(script, folder, "power")
    period_s = design.clock_ns * 1e-9
    rows = []
    for part in text.split("== ")[1:]:
        name = part.split("\n", 1)[0].strip()
        cells = [[float(n) for n in found] for found in _CELL.findall(part)]
        # OpenSTA counts the energy of a rising and a falling edge for every toggle.
        internal, switching, leakage = sum(c[0] for c in cells) / 2, sum(c[1] for c in cells), sum(c[2] for c in cells)
        joules = sum(
            count * memory_energy_pj(design, design.kinds[kinds[tuple(path.split("/"))]]) * 1e-12
            for path, count in accesses.items()
            if path.split("/")[0] == name
        )
        memory = joules / (cycles * period_s)
        if not cells and not memory:
            raise SynthError(f"OpenSTA gave no power of {name or 'the unit'}; see {folder}/power.log")
        rows.append(
            {
                "block": name or design.top,
                "activity": rates[name],
                "internal_w": internal,
                "switching_w": switching,
                "leakage_w": leakage,
                "memory_w": memory,
                "total_w": internal + switching + leakage + memory,
            }
        )
    progress(f"synth: power over {cycles} cycles of a rendered picture: {sum(r['total_w'] for r in rows):.3f} W")
    return {
        "kernel": " ".join(KERNEL[:4]),
        "cycles": cycles,
        "clock_ns": design.clock_ns,
        "blocks": rows,
        "total_w": sum(r["total_w"] for r in rows),
    }
