"""Power by block: the toggles of the simulated netlist, averaged over each block, given to OpenSTA."""
import math
import os
import re

from . import replay, timing
from .errors import SynthError, say

KERNEL = ["sim", "room", "--size", "8x8", "--depth", "1"]


def below_unit(name):
    """The path below compute_unit of a name as the simulator writes it."""
    words = name.split(".")
    last = max((i for i, w in enumerate(words) if w == "compute_unit"), default=0)
    return "/".join(words[last + 1:])


def measure(design, folder):
    """Simulates the netlist on a small picture. Returns toggles and nets by instance path, accesses of memories, cycles."""
    library = replay.build(design, folder, count=True)
    passed, text = replay.lockstep(design, library, folder, KERNEL, engine="rtl")
    if not passed:
        raise SynthError("the netlist did not draw the frame whose activity was to be measured")
    toggles, accesses, cycles = {}, {}, 0
    for line in text.splitlines():
        words = line.split()
        if words[:1] == ["TOGGLES"]:
            toggles[below_unit(words[1])] = (int(words[2]), int(words[4]))
            cycles = max(cycles, int(words[3]))
        elif words[:1] == ["ACCESSES"]:
            accesses[below_unit(words[1]).rpartition("/")[0] if words[1].endswith(".ram") else below_unit(words[1])] = int(words[2])
    if not toggles or not cycles:
        raise SynthError(f"the simulated netlist counted no toggles; see {folder}/sim.log")
    return toggles, accesses, cycles


def activity(toggles, cycles, prefix):
    """Toggles a cycle and net, averaged over all nets of the instances at or below a path."""
    total = nets = 0
    for path, (count, bits) in toggles.items():
        if path == prefix or path.startswith(prefix + "/"):
            total += count
            nets += bits
    return total / (nets * cycles) if nets else 0.0


def memory_energy_pj(design, kind):
    """One access, scaled from the reference: capacitance with the square root of the area of a gate, and the voltage squared."""
    voltage = float(design.library.group.attributes.get("nom_voltage", 1.1))
    return design.memory.energy_pj(kind) * math.sqrt(design.memory.scale) * (voltage / 1.1) ** 2


def estimate(design):
    """Watt by first-level block: [{block, activity, internal_w, switching_w, leakage_w, memory_w, total_w}]."""
    folder = os.path.join(design.folder, "power")
    toggles, accesses, cycles = measure(design, folder)
    top = design.netlist.modules[design.netlist.top]
    rates = {name: activity(toggles, cycles, name) for name in top.blocks}
    script = timing.set_up(design.verilog, design.library, design.macros, design.clock_ns)
    for name, rate in rates.items():
        script += (f'set_power_activity -global -activity {rate:.6f}\nset_power_activity -input -activity {rate:.6f}\n'
                   f'puts "== {name}"\nreport_power -instances [get_cells {name}] -digits 6\n')
    text = timing.run_sta(script, folder, "power")
    kinds = dict(design.netlist.instances())
    period_s = design.clock_ns * 1e-9
    rows = []
    for part in text.split("== ")[1:]:
        name = part.split()[0]
        numbers = re.search(r"^\s*([\d.eE+-]+)\s+([\d.eE+-]+)\s+([\d.eE+-]+)\s+([\d.eE+-]+)\s+" + re.escape(name) + r"\s*$", part, re.M)
        if not numbers:
            raise SynthError(f"OpenSTA gave no power of {name}; see {folder}/power.log")
        # OpenSTA counts the energy of a rising and a falling edge for every toggle.
        internal, switching, leakage = float(numbers[1]) / 2, float(numbers[2]), float(numbers[3])
        joules = sum(count * memory_energy_pj(design, design.kinds[kinds[tuple(path.split("/"))]]) * 1e-12
                     for path, count in accesses.items() if path.split("/")[0] == name and tuple(path.split("/")) in kinds)
        memory = joules / (cycles * period_s)
        rows.append({"block": name, "activity": rates[name], "internal_w": internal, "switching_w": switching, "leakage_w": leakage,
                     "memory_w": memory, "total_w": internal + switching + leakage + memory})
    say(f"synth: power over {cycles} cycles of a rendered picture: {sum(r['total_w'] for r in rows):.3f} W")
    return {"kernel": " ".join(KERNEL[:4]), "cycles": cycles, "clock_ns": design.clock_ns, "blocks": rows,
            "total_w": sum(r["total_w"] for r in rows)}
