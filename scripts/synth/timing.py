"""Times a netlist with OpenSTA: the slowest path of the whole and of each block, and the FO4 delay of the library."""
import os
import re
import subprocess
from dataclasses import dataclass

from .errors import SynthError, need, run
from .library import ROOT

FO4_STAGES = 12


def sta():
    return need("sta", "opensta")


def version():
    done = subprocess.run([sta(), "-version"], capture_output=True, text=True, check=False)
    return (done.stdout + done.stderr).split()[0]


def run_sta(script, folder, name):
    """Runs OpenSTA on the text of a script; returns what it printed.
    Its own errors do not end it: they are looked for.
    """
    path, log = os.path.join(folder, name + ".tcl"), os.path.join(folder, name + ".log")
    with open(path, "w", encoding="utf-8") as file:
        file.write(script + "\nexit\n")
    run([sta(), "-no_splash", "-exit", path], log)
    with open(log, encoding="utf-8", errors="replace") as file:
        text = file.read()
    bad = [line for line in text.splitlines() if line.startswith("Error") or "not found" in line]
    if bad:
        raise SynthError(f"OpenSTA: {bad[0]} (the whole of it is in {log})")
    return text


def measure_fo4(library, folder):
    """ns through an inverter that drives four of its kind: the mean over the middle of a chain."""
    os.makedirs(folder, exist_ok=True)
    cell = library.cells[library.inverter]
    a, y = cell.inputs()[0].name, cell.outputs()[0].name
    gates = []
    for stage in range(FO4_STAGES):
        gates.append(f"{cell.name} s{stage} (.{a}(n{stage}), .{y}(n{stage + 1}));")
        gates += [f"{cell.name} l{stage}_{k} (.{a}(n{stage + 1}), .{y}(u{stage}_{k}));" for k in range(3)]
    wires = [f"n{s}" for s in range(1, FO4_STAGES)] + [f"u{s}_{k}" for s in range(FO4_STAGES) for k in range(3)]
    netlist = os.path.join(folder, "fo4.v")
    with open(netlist, "w", encoding="utf-8") as file:
        file.write(
            f"module fo4 (n0, n{FO4_STAGES});\n  input n0;\n  output n{FO4_STAGES};\n  wire {', '.join(wires)};\n  "
            + "\n  ".join(gates)
            + "\nendmodule\n"
        )
    text = run_sta(
        f"""read_liberty {library.whole_file()}
read_verilog {netlist}
link_design fo4
create_clock -name virtual -period 100
set_input_delay 0 -clock virtual [get_ports n0]
set_output_delay 0 -clock virtual [get_ports n{FO4_STAGES}]
set_input_transition 0.1 [get_ports n0]
report_checks -path_delay max -digits 5""",
        folder,
        "fo4",
    )
    at = {int(m[2]): float(m[1]) for m in re.finditer(r"^\s*[\d.]+\s+([\d.]+)\s+[\^v]\s+s(\d+)/" + y, text, re.M)}
    if 3 not in at or FO4_STAGES - 3 not in at:
        raise SynthError(f"OpenSTA did not time the inverter chain of {library.inverter}; see {folder}/fo4.log")
    return (at[FO4_STAGES - 3] - at[3]) / (FO4_STAGES - 6)


@dataclass
class Endpoint:
    pin: str
    slack: float


def set_up(netlist_path, library, macros, clock_ns, top):
    """The constraints of any module, and what else is known of this one."""
    names = [os.path.join(ROOT, "constraints", f"{name}.sdc") for name in ("module", top)]
    constraints = "\n".join(f"source {name}" for name in names if os.path.exists(name))
    macro = f"read_liberty {macros}\n" if macros else ""
    return f"""read_liberty {library.whole_file()}
{macro}read_verilog {netlist_path}
link_design {top}
set raypool_clock_ns {clock_ns}
set raypool_driver {library.driver}
{constraints}
"""


_END = re.compile(r"^(?P<pin>\S+)\s+\(\S+\)\s+-?[\d.]+\s+-?[\d.]+\s+(?P<slack>-?[\d.]+)\s")


def time_netlist(netlist_path, library, macros, clock_ns, folder, top):
    """Endpoints with their slack in ns, worst first, and the text of OpenSTA's check for loops."""
    text = run_sta(
        set_up(netlist_path, library, macros, clock_ns, top)
        + """
puts "== loops"
check_setup -loops -verbose
puts "== endpoints"
report_checks -path_delay max -format end -group_count 1000000 -digits 4
puts "== end"
""",
        folder,
        "endpoints",
    )
    loops = text.split("== loops")[1].split("== endpoints")[0].strip()
    listing = text.split("== endpoints")[1].split("== end")[0]
    endpoints = []
    for line in listing.splitlines():
        end = _END.match(line)
        if end:
            endpoints.append(Endpoint(end["pin"], float(end["slack"])))
    if not endpoints:
        raise SynthError(f"OpenSTA reported no path; see {folder}/endpoints.log")
    return sorted(endpoints, key=lambda e: e.slack), loops


_STEP = re.compile(r"^\s*(?P<delay>-?[\d.]+)\s+(?P<time>-?[\d.]+)\s+(?P<edge>[\^v])\s+(?P<pin>\S+)\s+\((?P<cell>\S+)\)")


def describe(pins, netlist_path, library, macros, clock_ns, folder, top):
    """The slowest path to each of the given end points: [(start, end, [(pin, cell, delay, time)])], in their order."""
    commands = "\n".join(f'puts "== path"\nreport_checks -path_delay max -to {{{pin}}} -digits 4' for pin in pins)
    text = run_sta(set_up(netlist_path, library, macros, clock_ns, top) + commands, folder, "paths")
    found = []
    for part in text.split("== path")[1:]:
        start = re.search(r"Startpoint: (\S+)", part)
        end = re.search(r"Endpoint: (\S+)", part)
        steps = []
        for line in part.split("data arrival time")[0].splitlines():
            step = _STEP.match(line)
            if step:
                steps.append((step["pin"], step["cell"], float(step["delay"]), float(step["time"])))
        found.append((start[1] if start else "", end[1] if end else "", steps))
    return found
