"""Runs the mapped netlist, with the library's Verilog cells, in lockstep with the golden model."""
import os
import re
import subprocess

from . import elaborate
from .errors import SynthError, run, say
from .function import truth, verilog
from .library import ROOT

SCENE = ["sim", "cornell", "--size", "8x8", "--depth", "2"]
PROGRAMS = 20


def library_modules(path):
    """The text of each module of a Verilog cell library, by name."""
    if not path or not os.path.isfile(path):
        return {}
    with open(path, encoding="utf-8", errors="replace") as file:
        text = file.read()
    return {m[1]: m[0] for m in re.finditer(r"\bmodule\s+(\w+)\b.*?\bendmodule", text, re.S)}


def behavioural(cell):
    """A cell from its Liberty description. Flip-flops have a clock and data alone; others are not used."""
    pins = list(cell.pins.values())
    lines = [f"module {cell.name} ({', '.join(p.name for p in pins)});"]
    lines += [f"  {p.direction} {p.name};" for p in pins]
    if cell.kind == "flop":
        state = cell.sequential
        if "clear" in state.attributes or "preset" in state.attributes:
            raise SynthError(f"the netlist uses {cell.name}, a flip-flop with clear or preset, which the flow does not simulate")
        names = state.arguments
        clock = state.attributes["clocked_on"]
        edge = "negedge" if "!" in clock or "'" in clock else "posedge"
        lines.append(f"  reg {names[0]};")
        lines.append(f"  always @({edge} {re.sub(r'[^A-Za-z0-9_]', '', clock)}) {names[0]} <= {verilog(state.attributes['next_state'])};")
        for pin in cell.outputs():
            lines.append(f"  assign {pin.name} = {'~' if pin.function == names[1] else ''}{names[0]};")
    else:
        lines += [f"  assign {p.name} = {verilog(p.function)};" for p in cell.outputs()]
    return "\n".join(lines + ["endmodule"]) + "\n"


def cells_file(design, path):
    """The Verilog of every cell in use: the library's own text, and where that needs tables (UDP), which Verilator does not read, or is
    missing, what the Liberty file says. Returns how many came from each."""
    used = sorted({c for i in design.netlist.modules for c in design.netlist.gate_count(i)})
    own = library_modules(design.library.verilog)
    tables = set()
    if own:
        with open(design.library.verilog, encoding="utf-8", errors="replace") as file:
            tables = set(re.findall(r"\bprimitive\s+(\w+)", file.read()))
    taken = 0
    with open(path, "w", encoding="utf-8") as file:
        for name in used:
            text = own.get(name)
            if text and not any(re.search(r"\b" + t + r"\b", text) for t in tables):
                file.write(text + "\n")
                taken += 1
            else:
                file.write(behavioural(design.library.cells[name]))
    return taken, len(used) - taken


def memories_file(design, path, count=False):
    """Each memory block as an instance of the RTL's memory."""
    with open(path, "w", encoding="utf-8") as file:
        for kind in {k.name: k for k in design.blocks()}.values():
            ports = ", ".join(kind.ports)
            file.write(f"module {kind.name} ({ports});\n")
            for name, (direction, width) in kind.ports.items():
                file.write(f"  {direction} {f'[{width - 1}:0] ' if width > 1 else ''}{name};\n")
            parameters = ", ".join(f".{n}({int(v, 2)})" for n, v in kind.parameters.items())
            file.write(f"  {kind.base} #({parameters}) ram ({', '.join(f'.{p}({p})' for p in kind.ports)});\n")
            if count:
                enables = [p for p in kind.ports if p in ("enable_i", "read_i", "write_i", "write_mask_i") and
                           not (kind.base == "ram_1rw" and p == "write_i")]
                file.write("  longint unsigned accesses = 0;\n  always @(posedge clk_i) accesses <= accesses + " +
                           " + ".join(f"64'(|{p})" for p in enables) + ";\n"
                           "  final $display(\"ACCESSES %m %0d\", accesses);\n")
            file.write("endmodule\n")


def counting(module):
    """Lines that count how often a module's own nets change, once a cycle: delays and glitches are not simulated."""
    names = [n for n in module.names.values()]
    if not names or not any(p[0] == "clk_i" for p in module.ports):
        return []
    bits = len(names)
    joined = ",".join(names)
    return [f"wire [{bits - 1}:0] all_nets = {{{joined}}};", f"reg [{bits - 1}:0] was_nets; longint unsigned toggles = 0, cycles = 0;",
            "always @(posedge clk_i) begin was_nets <= all_nets; cycles <= cycles + 1; "
            "if (cycles != 0) toggles <= toggles + 64'($countones(all_nets ^ was_nets)); end",
            f"final $display(\"TOGGLES %m %0d %0d {bits}\", toggles, cycles);"]


def broken(design, number, base="int_alu"):
    """Swaps the function of one cell, for a test of the test: a gate of block `base`, chosen by `number`, that has a partner cell with
    the same pins and another function. Returns what was done, in words."""
    library = design.library
    partners = {}
    for cell in library.usable.values():
        if cell.kind == "gate" and len(cell.outputs()) == 1:
            partners.setdefault(tuple(sorted(cell.pins)), []).append(cell)
    module = next(m for m in design.netlist.modules.values() if m.kind.base == base)
    seen = 0
    for name, (cell_name, pins) in module.gates.items():
        cell = library.cells[cell_name]
        if cell.kind != "gate" or len(cell.inputs()) < 2 or any(isinstance(n, str) for n in pins.values()):
            continue
        inputs = sorted(p.name for p in cell.inputs())
        mine = truth(cell.outputs()[0].function, inputs)
        for other in partners.get(tuple(sorted(cell.pins)), []):
            if truth(other.outputs()[0].function, inputs) != mine:
                if seen == number * 7:
                    module.gates[name] = (other.name, pins)
                    return f"{module.name}/{name}: {cell_name} became {other.name}"
                seen += 1
                break
    raise SynthError(f"BREAK={number}: {base} has only {seen} cells that could be swapped; take a smaller number")


def build(design, folder, count=False):
    """Verilates the netlist; returns the shared library's path."""
    os.makedirs(folder, exist_ok=True)
    netlist = os.path.join(folder, "netlist.v")
    top = design.kinds[design.netlist.top].parameters
    design.netlist.write(netlist, counting if count else None, {n: int(v, 2) for n, v in top.items()})
    cells, memories = os.path.join(folder, "cells.v"), os.path.join(folder, "memories.v")
    own, derived = cells_file(design, cells)
    memories_file(design, memories, count)
    say(f"replay: {own} cells from the library's Verilog, {derived} from its Liberty file (flip-flops); building the netlist's simulator")
    options = [o for f in [netlist, cells, memories] for o in ("--netlist", f)]
    parameters = [f"{n}={v}" for n, v in design.parameters.items()]
    run([os.path.join(ROOT, "scripts", "verilate.sh"), folder, *options, *parameters], os.path.join(folder, "build.log"),
        environment={"JOBS": str(design.options.jobs)})
    return os.path.join(folder, "libraypool_unit.so")


def lockstep(design, library, folder, arguments, engine="lockstep"):
    """Runs raypool on the netlist; returns (passed, output)."""
    command = [elaborate.raypool(), *arguments, "--config", design.options.config, "--engine", engine, "--unit-library", library]
    if arguments[0] == "sim":
        command += ["--out", os.path.join(folder, "picture"), "--quiet"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    text = done.stdout + done.stderr
    with open(os.path.join(folder, arguments[0] + ".log"), "w", encoding="utf-8") as file:
        file.write(" ".join(command) + "\n" + text)
    if done.returncode not in (0, 2):
        raise SynthError(f"raypool {arguments[0]} failed: {text.strip().splitlines()[-1] if text.strip() else done.returncode}")
    return done.returncode == 0, text


def replay(design, break_number=0):
    """Replays kernels and random programs. Raises when an intact netlist differs or a broken one does not."""
    folder = os.path.join(design.folder, "replay" + (f"-broken{break_number}" if break_number else ""))
    what = broken(design, break_number) if break_number else None
    if what:
        say(f"replay: broken on purpose: {what}")
    library = build(design, folder)
    runs = [SCENE, ["cosim", "--programs", str(PROGRAMS), "--seed", "1"]]
    for arguments in runs:
        passed, text = lockstep(design, library, folder, arguments)
        words = " ".join(arguments[:2])
        if not passed and what:
            say(f"replay: {words} noticed it: {text.strip().splitlines()[0]}")
            return
        if not passed:
            raise SynthError(f"the netlist differs from the golden model in `raypool {' '.join(arguments)}`:\n{text.strip()}")
        if arguments[0] == "cosim":
            say("replay: " + " ".join(text.strip().splitlines()))
        else:
            say(f"replay: {words}: the netlist drew the frame, no difference from the golden model; see {folder}")
    if what:
        raise SynthError(f"a broken netlist passed the replay ({what})")
