"""Runs the mapped netlist, with the functions of the library's Verilog cells, in lockstep with the golden model."""
import array
import json
import os
import re
import subprocess

from . import clock_gates, elaborate
from .errors import SynthError, need, run, say
from .function import truth
from .library import ROOT

SCENE = ["sim", "cornell", "--size", "8x8"]
# What names the wires in a top that its wrapper reads, beside its ports.
PROBES = os.path.join(ROOT, "sim", "rtl", "{}_probes.vlt")
PROGRAMS = 20
# What joins two nets and is no cell of the library, as the first two kinds of gate.
BUFFER, INVERTER = 0, 1
# Stands for the clock gate before a register: (data, enable, state) to what the register holds next.
ENABLED = (("data", "enable", "state"), 0b10111000, False)
# The ports of a memory that are not 0 when it is accessed; one read of two words is two accesses.
ACCESSES = {
    "ram_1rw": ["enable_i"],
    "ram_1r1w": ["read_i", "write_i"],
    "ram_2r1w": ["read_i", "read_i", "write_mask_i"],
}


def library_modules(path):
    """The text of each module of a Verilog cell library, by name."""
    if not path or not os.path.isfile(path):
        return {}
    with open(path, encoding="utf-8", errors="replace") as file:
        text = file.read()
    return {m[1]: m[0] for m in re.finditer(r"\bmodule\s+(\w+)\b.*?\bendmodule", text, re.S)}


def tables(design, folder):
    """The truth table of every output of every cell in use, by (cell, output): (inputs, table, whether it is a
    register). From the library's own Verilog; where that uses tables (UDP), which Yosys does not read, or is missing,
    from the Liberty file. Reports how many came from each.
    """
    used = [
        design.library.cells[c]
        for c in sorted({c for i in design.netlist.modules for c in design.netlist.gate_count(i)})
    ]
    own = library_modules(design.library.verilog)
    udp = set()
    if own:
        with open(design.library.verilog, encoding="utf-8", errors="replace") as file:
            udp = set(re.findall(r"\bprimitive\s+(\w+)", file.read()))
    known = {
        c.name
        for c in used
        if c.kind == "gate" and c.name in own and not any(re.search(rf"\b{t}\b", own[c.name]) for t in udp)
    }
    evaluated = evaluate([c for c in used if c.name in known], own, folder) if known else {}
    found = {}
    for cell in used:
        for pin in cell.outputs():
            if cell.kind == "clock_gate":
                found[cell.name, pin.name] = ENABLED
            elif cell.kind == "flop":
                found[cell.name, pin.name] = flop_table(cell)
            else:
                inputs = [p.name for p in cell.inputs()]
                table = evaluated[cell.name, pin.name] if cell.name in known else truth(pin.function, inputs)
                if table != truth(pin.function, inputs):
                    raise SynthError(
                        f"{cell.name}: the library's Verilog and its Liberty file give {pin.name} different functions"
                    )
                found[cell.name, pin.name] = (inputs, table, False)
            if len(found[cell.name, pin.name][0]) > 6:
                raise SynthError(f"the netlist uses {cell.name}, which has more inputs than the replay simulates")
    say(
        f"replay: {len(known)} cells as the library's Verilog has them, {len(used) - len(known)} as its Liberty file "
        "(flip-flops)"
    )
    return found


def flop_table(cell):
    """Flip-flops have a clock and data, and some a clear or preset that is never active; others are not used."""
    state = cell.sequential
    clock = clock_gates.flop_clock(cell)
    if "!" in clock or "'" in clock:
        raise SynthError(
            f"the netlist uses {cell.name}, a flip-flop with a falling clock, which the flow does not simulate"
        )
    inputs = [p.name for p in cell.inputs() if p.name != clock]
    return inputs, truth(state.attributes["next_state"], inputs), True


def check_never_forced(cell, pins):
    """A clear or preset is connected to a constant that leaves the register alone."""
    for word in ("clear", "preset"):
        function = cell.sequential.attributes.get(word)
        if not function:
            continue
        names = [p.name for p in cell.inputs() if p.name in re.findall(r"\w+", function)]
        constants = [pins[n] for n in names]
        if any(not isinstance(c, str) for c in constants) or (
            truth(function, names) >> sum(int(c) << i for i, c in enumerate(constants)) & 1
        ):
            raise SynthError(f"the netlist uses the {word} of {cell.name}, which the flow does not simulate")


def evaluate(cells, own, folder):
    """Truth tables of cells by their Verilog, as Yosys evaluates it."""
    source, script = os.path.join(folder, "cells.v"), os.path.join(folder, "cells.ys")
    with open(source, "w", encoding="utf-8") as file:
        file.write("\n".join(own[c.name] for c in cells) + "\n")
    with open(script, "w", encoding="utf-8") as file:
        file.write(f"read_verilog {source}\n")
        for cell in cells:
            for pin in cell.outputs():
                file.write(
                    f"cd {cell.name}\nlog == {cell.name} {pin.name}\neval -table "
                    f"{','.join(p.name for p in cell.inputs())} -show {pin.name}\ncd ..\n"
                )
    log = os.path.join(folder, "cells.log")
    run([need("yosys", "yosys"), script], log)
    with open(log, encoding="utf-8") as file:
        parts = re.split(r"^== (\w+) (\w+)$", file.read(), flags=re.M)[1:]
    found = {}
    for cell, pin, text in zip(parts[::3], parts[1::3], parts[2::3]):
        rows = re.findall(r"^ ((?:1'[01] +)+)\| 1'([01])$", text, re.M)
        # The first input is the lowest bit.
        found[cell, pin] = sum(
            int(value) << sum(int(b[-1]) << i for i, b in enumerate(bits.split())) for bits, value in rows
        )
    return found


def flatten(netlist, found):
    """The whole netlist as gates between numbered nets, 0 and 1 the constants: (nets, gates as (cell, output, inputs'
    nets, output's net), blocks as (path, first gate, last), memories as (path, kind, {port: nets}), what else joins
    nets as (BUFFER or INVERTER, source, sink), the top's nets).
    """
    library = netlist.library
    gates, blocks, memories, joins = [], [], [], []
    used = 2

    def visit(identity, path, outside):
        nonlocal used
        module = netlist.modules[identity]
        inside = {"0": 0, "1": 1}
        for name, _, nets in sorted(module.ports, key=lambda p: p[1] == "output"):
            for inner, outer in zip(nets, outside[name]):
                if inside.setdefault(inner, outer) != outer:
                    # an input or a constant at an output, or one net at two
                    joins.append((BUFFER, inside[inner], outer))
        for net in module.names:
            if net not in inside:
                inside[net] = used
                used += 1
        first = len(gates)
        behind = clock_gates.enables(library, module)
        for cell, pins in module.gates.values():
            known = library.cells[cell]
            for output in known.outputs():
                if output.name not in pins or known.kind == "clock_gate":
                    continue
                sink = inside[pins[output.name]]
                sources = {p: inside[pins[p]] for p in found[cell, output.name][0]}
                if known.kind == "flop":
                    check_never_forced(known, pins)
                    if not known.shows_state(output.name):
                        joins.append((INVERTER, used, sink))
                        sink, used = used, used + 1
                    gate = behind.get(pins[clock_gates.flop_clock(known)])
                    if gate:
                        data = known.sequential.attributes["next_state"].strip("() ")
                        enabled = [sources[data], inside[gate[1]], sink]
                        sources[data], used = used, used + 1
                        gates.append((library.clock_gate, library.gate_output, enabled, sources[data]))
                gates.append((cell, output.name, list(sources.values()), sink))
        blocks.append(("/".join(path), first, len(gates)))
        for label, (child, ports) in module.blocks.items():
            nets = {p: [inside[n] for n in bits] for p, bits in ports.items()}
            if not path:
                top.update({(module.originals[label], p): bits for p, bits in nets.items()})
            if child in netlist.modules:
                visit(child, path + (label,), nets)
            else:
                memories.append(("/".join(path + (label,)), netlist.kinds[child], nets))

    top = {}
    for name, _, nets in netlist.modules[netlist.top].ports:
        top["", name] = list(range(used, used + len(nets)))
        used += len(nets)
    visit(netlist.top, (), {port: nets for (_, port), nets in top.items()})
    return used, gates, blocks, memories, joins, top


def probed(design, top):
    """The nets of the wires that the top's wrapper reads: [(name, nets)]."""
    path = PROBES.format(design.top)
    if not os.path.exists(path):
        return []
    with open(path, encoding="utf-8") as file:
        names = re.findall(rf'^public_flat_rd -module "{elaborate.PREFIX}{design.top}" -var "(\w+)"', file.read(), re.M)
    wires = design.kinds[design.netlist.top].wires
    found = []
    for name in names:
        drivers = wires.get(name, [None])
        if None in drivers:
            raise SynthError(
                f"{path}: {elaborate.PREFIX}{design.top}.v has no wire {name} that one of its blocks or inputs drives: "
                "the netlist has none of this name"
            )
        found.append((name, [int(d) if isinstance(d, str) else top[d[:2]][d[2]] for d in drivers]))
    return found


def simulator(design, folder, count):
    """Writes the netlist as sim/rtl/gate_simulator.cpp reads it, and the Verilog that stands in for its top, a compute
    unit or a chip: that simulator and the RTL's memories. With `count` it prints at its end how often nets changed and
    memories were accessed. Returns the Verilog's path.
    """
    found = tables(design, folder)
    nets, gates, blocks, memories, joins, top = flatten(design.netlist, found)
    unit = design.kinds[design.netlist.top]
    inputs = [(p, top["", p]) for p, (direction, _) in unit.ports.items() if direction == "input" and p != "clk_i"]
    outputs = [(p, top["", p]) for p, (direction, _) in unit.ports.items() if direction == "output"]
    lines = []
    for name, wire in probed(design, top):
        lines.append(f"  wire [{len(wire) - 1}:0] {name};")
        outputs.append((name, wire))
    for place, (path, kind, connected) in enumerate(memories):
        connections = [".clk_i(clk_i)"]
        for port, (direction, width) in kind.ports.items():
            if port != "clk_i":
                name = f"ram_{place}_{port}"
                lines.append(f"  wire [{width - 1}:0] {name};")
                connections.append(f".{port}({name})")
                (outputs if direction == "input" else inputs).append((name, connected.get(port, [0] * width)))
        parameters = ", ".join(f".{n}({int(v, 2)})" for n, v in kind.parameters.items())
        lines.append(f"  {elaborate.PREFIX}{kind.base} #({parameters}) ram_{place} ({', '.join(connections)});")
        if count:
            lines += [
                f"  longint unsigned accesses_{place} = 0;",
                f"  always @(posedge clk_i) accesses_{place} <= accesses_{place} + "
                + " + ".join(f"64'(ram_{place}_{p} != 0)" for p in ACCESSES[kind.base])
                + ";",
                f'  final $display("ACCESSES %0d {path}", accesses_{place});',
            ]
    data, shell = os.path.join(folder, "netlist.bin"), os.path.join(folder, design.top + ".sv")
    entering, leaving = [[n for _, listed in ports for n in listed] for ports in (inputs, outputs)]
    number = {place: i + 2 for i, place in enumerate(found)}
    words = array.array("I", [nets, len(found) + 2, len(gates) + len(joins), len(entering), len(leaving), len(blocks)])
    words.extend((1, 0, 0b10, 0, 1, 0, 0b01, 0))  # BUFFER, INVERTER
    for sources, table, flop in found.values():
        words.extend((len(sources), int(flop), table & 0xFFFFFFFF, table >> 32))
    for cell, output, sources, sink in gates:
        words.extend((number[cell, output], *sources, sink))
    for join in joins:
        words.extend(join)
    words.extend(entering + leaving)
    for path, first, last in blocks:
        words.extend((first, last, len(path), *path.encode()))
    with open(data, "wb") as file:
        words.tofile(file)
    with open(shell, "w", encoding="utf-8") as file:
        listed = ", ".join(f"parameter {n} = {int(v, 2)}" for n, v in unit.parameters.items())
        file.write(f"module {elaborate.PREFIX}{design.top} #({listed}) ({', '.join(unit.ports)});\n")
        for name, (direction, width) in unit.ports.items():
            file.write(f"  {direction} [{width - 1}:0] {name};\n")
        file.write(
            "\n".join(lines)
            + f"""
  import "DPI-C" function chandle netlist_open(input string path);
  import "DPI-C" function void netlist_settle(input chandle netlist, input bit [{len(entering) - 1}:0] entering,
    output bit [{len(leaving) - 1}:0] leaving);
  import "DPI-C" function void netlist_clock(input chandle netlist);
  import "DPI-C" function void netlist_close(input chandle netlist, input bit report);
  chandle netlist = netlist_open("{data}");
  reg edges = 0;
  reg [{len(leaving) - 1}:0] leaving;
  wire [{len(entering) - 1}:0] entering = {{{', '.join(n for n, _ in reversed(inputs))}}};
  always @(posedge clk_i) begin netlist_clock(netlist); edges <= ~edges; end
  function automatic [{len(leaving) - 1}:0] settled(input bit after_edge, input bit [{len(entering) - 1}:0] values);
    netlist_settle(netlist, values, settled);
  endfunction
  always @* leaving = settled(edges, entering);
  assign {{{', '.join(n for n, _ in reversed(outputs))}}} = leaving;
  final netlist_close(netlist, {int(count)});
endmodule
"""
        )
    return shell


def broken(design, number, base):
    """Swaps the function of one cell, for a test of the test: a gate of block `base`, chosen by `number`, that has a
    partner cell with
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
    """Builds the netlist's simulator; returns the shared library's path."""
    os.makedirs(folder, exist_ok=True)
    shell = simulator(design, folder, count)
    parameters = [f"{n}={v}" for n, v in design.parameters.items()]
    kind = "chip" if design.options.units else "unit"
    top = ["--top", "chip"] if design.options.units else []
    run(
        [os.path.join(ROOT, "scripts", "verilate.sh"), folder, *top, "--netlist", shell, *parameters],
        os.path.join(folder, "build.log"),
        environment={"JOBS": str(design.options.jobs)},
    )
    return os.path.join(folder, f"libraypool_{kind}.so")


def lockstep(design, library, folder, arguments, engine="lockstep"):
    """Runs raypool on the netlist; returns (passed, output). Of a chip always in lockstep with the model."""
    units = design.options.units
    chip = ["--boundary", "chip", "--units", str(units)] if units else []
    engines = ["--engine", "lockstep" if units else engine, *chip]
    command = [elaborate.raypool(), *arguments, "--config", design.options.config, *engines, "--unit-library", library]
    if arguments[0] == "sim":
        command += ["--out", os.path.join(folder, "picture"), "--quiet"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    text = done.stdout + done.stderr
    with open(os.path.join(folder, arguments[0] + ".log"), "w", encoding="utf-8") as file:
        file.write(" ".join(command) + "\n" + text)
    if done.returncode not in (0, 2):
        raise SynthError(
            f"raypool {arguments[0]} failed: {text.strip().splitlines()[-1] if text.strip() else done.returncode}"
        )
    return done.returncode == 0, text


def replay(design, break_number=0):
    """Replays kernels and random programs. Raises when an intact netlist differs or a broken one does not."""
    folder = os.path.join(design.folder, "replay" + (f"-broken{break_number}" if break_number else ""))
    # Of a chip a block that a picture goes through: programs, which try every instruction, run on a unit alone.
    base = "ray_pool" if design.options.units else "int_alu"
    what = broken(design, break_number, base) if break_number else None
    if what:
        say(f"replay: broken on purpose: {what}")
    library = build(design, folder)
    # A failing program is minimised into the netlist's folder: its fault is not the RTL's.
    # A machine that was fitted may have no reflections.
    chip = json.loads(elaborate.ask(design.options.config, "--json"))["chip"]
    runs = [
        SCENE + ["--depth", "2" if chip["reflections"] else "1"],
        ["cosim", "--programs", str(PROGRAMS), "--seed", "1", "--save", folder] + (["--no-minimise"] if what else []),
    ][: 1 if design.options.units else 2]  # programs alone run on a unit
    for arguments in runs:
        passed, text = lockstep(design, library, folder, arguments)
        words = arguments[0]
        if not passed and what:
            said = [line.strip() for line in text.splitlines() if "differ" in line or "look at:" in line]
            say(
                f"replay: {words} detected it: "
                + "; ".join(said[:1] + [line for line in said if line.startswith("look at:")])
            )
            return
        if not passed:
            raise SynthError(
                f"the netlist differs from the golden model in `raypool {' '.join(arguments)}`:\n{text.strip()}"
            )
        if arguments[0] == "cosim":
            say("replay: " + " ".join(text.strip().splitlines()))
        else:
            say(f"replay: {words}: the netlist drew the frame, no difference from the golden model; see {folder}")
    if what:
        raise SynthError(f"a broken netlist passed the replay ({what})")
