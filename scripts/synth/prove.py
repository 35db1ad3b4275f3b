"""Proves each mapped block equal to its RTL: both as and-inverter graphs, a miter, then ABC.
Children are cut off at their ports.
"""
import concurrent.futures
import hashlib
import json
import os
import re
import subprocess

from . import clock_gates, mapping
from .elaborate import PREFIX, defines, read_rtl, rtl_texts, text_of
from .errors import need, run

SECONDS = 120
ABC = "read_aiger {aig}; strash; scorr; dprove"


def escaped(name):
    return f"\\{name} "


def gate_module(design, module):
    """The mapped block with its children's ports as its own, under the names that Yosys' expose -evert gives them."""
    own = {n: v for n, v in module.names.items()}

    def text(net):
        return f"1'b{net}" if isinstance(net, str) else own[net]

    lines, ports, outputs = [], [], []
    for name, direction, nets in module.ports:
        ports.append(name)
        lines.append(f"  {direction} {f'[{len(nets) - 1}:0] ' if len(nets) > 1 else ''}{name};")
        if direction == "output":
            for i, net in enumerate(nets):
                label = f"{name}[{i}]" if len(nets) > 1 else name
                if text(net) != label:
                    outputs.append(f"  assign {label} = {text(net)};")
    for label, (identity, connections) in module.blocks.items():
        original = module.originals[label]
        for port, (direction, width) in design.kinds[identity].ports.items():
            name = escaped(f"{original}.{port}")
            ports.append(name)
            span = f"[{width - 1}:0] " if width > 1 else ""
            # What a child takes leaves the block, and what it gives comes in.
            lines.append(f"  {'output' if direction == 'input' else 'input'} {span}{name};")
            for i, net in enumerate(connections.get(port, [])):
                bit = f"{name}[{i}]" if width > 1 else name
                if direction == "input":
                    outputs.append(f"  assign {bit} = {text(net)};")
                elif not isinstance(net, str):
                    outputs.append(f"  assign {text(net)} = {bit};")
    taken = {p[0] for p in module.ports}
    wires = [n for n in own.values() if n.split("[")[0] not in taken]
    gates = gate_lines(design.library, module, text)
    declared = [f"  wire {', '.join(wires[i:i + 12])};" for i in range(0, len(wires), 12)]
    return "\n".join([f"module gate ({', '.join(ports)});", *lines, *declared, *outputs, *gates, "endmodule", ""])


def gate_lines(library, module, text):
    """The cells of a block; a register behind a clock gate as one that keeps its value by a multiplexer."""
    behind = clock_gates.enables(library, module)
    lines = []
    for label, (name, pins) in module.gates.items():
        cell = library.cells[name]
        if cell.kind == "clock_gate":
            continue
        words = {p: text(n) for p, n in pins.items()}
        if cell.kind == "flop" and pins[clock_gates.flop_clock(cell)] in behind:
            clock, enable = behind[pins[clock_gates.flop_clock(cell)]]
            words[clock_gates.flop_clock(cell)] = text(clock)
            output = next(p.name for p in cell.outputs() if p.name in pins)
            state = words[output] if cell.shows_state(output) else f"~{words[output]}"
            data = cell.sequential.attributes["next_state"].strip("() ")
            words[data] = f"{text(enable)} ? {words[data]} : {state}"
        lines.append(f"  {name} {label} ({', '.join(f'.{p}({w})' for p, w in words.items())});")
    return lines


def proof_module(design, module):
    """Around the miter: the first cycle is one of reset, as the encodings of state machines differ before it."""
    ports = [(n, len(nets)) for n, direction, nets in module.ports if direction == "input"]
    for label, (identity, _) in module.blocks.items():
        ports += [
            (f"{module.originals[label]}.{p}", w) for p, (d, w) in design.kinds[identity].ports.items() if d == "output"
        ]
    names = {n for n, _ in ports}
    reset = {"clk_i", "rst_ni"} <= names
    lines = [f"  input {f'[{w - 1}:0] ' if w > 1 else ''}{escaped('in_' + n)};" for n, w in ports]
    joined = [
        f".{escaped('in_' + n)}({escaped('in_' + n)}{'& started' if reset and n == 'rst_ni' else ''})" for n, _ in ports
    ]
    started = "reg started = 0; always @(posedge \\in_clk_i ) started <= 1;" if reset else "wire started = 1;"
    return "\n".join(
        [
            f"module proof ({', '.join([escaped('in_' + n) for n, _ in ports] + ['bad'])});",
            *lines,
            "  output bad;",
            "  wire trigger;",
            "  " + started,
            f"  miter miter ({', '.join(joined + ['.trigger(trigger)'])});",
            "  assign bad = trigger & started;",
            "endmodule",
            "",
        ]
    )


def prove_one(design, identity, folder, cells):
    """'proved', 'different', or why not. A register that only ever loads a constant counts as that constant,
    in the RTL too.
    """
    module = design.netlist.modules[identity]
    kind = module.kind
    gated = bool(design.library.clock_gate)
    stem = os.path.join(folder, kind.name)
    text = gate_module(design, module)
    source = text_of(rtl_texts(), kind.base)
    chosen = " ".join(f"-chparam {n} {mapping.constant(v)}" for n, v in sorted(kind.parameters.items()))
    script = f"""{read_rtl(gated)}
hierarchy -check -top {PREFIX}{kind.base} {chosen}
select -set kids * A:top %d
blackbox @kids
select -clear
proc
expose -evert t:*
opt_clean
memory_map
opt -fast
techmap
opt -fast
rename {PREFIX}{kind.base} gold
read_liberty -ignore_miss_func -overwrite {cells}
read_verilog {stem}.v
flatten gate
miter -equiv -flatten gold gate miter
read_verilog {stem}.proof.v
hierarchy -top proof
proc
flatten
setundef -undriven -zero
setundef -init -zero
opt -fast
techmap
opt -fast
dffunmap
setundef -zero
setundef -init -zero
abc -g AND -fast
opt_clean
write_aiger -zinit {stem}.aig
"""
    # Not where the project lies, nor which other files it has.
    steps = script.split("\n", 1)[1].replace(folder, "").replace(cells, "")
    key = hashlib.sha256(
        "\0".join(
            [
                source,
                text,
                defines(gated),
                steps,
                ABC,
                proof_module(design, module),
                json.dumps(kind.parameters, sort_keys=True),
                design.library.digest,
            ]
        ).encode()
    ).hexdigest()[:16]
    kept = stem + ".result"
    if os.path.exists(kept):
        with open(kept, encoding="utf-8") as file:
            result = json.load(file)
        if result["key"] == key:
            return result["verdict"]
    with open(stem + ".v", "w", encoding="utf-8") as file:
        file.write(text)
    with open(stem + ".proof.v", "w", encoding="utf-8") as file:
        file.write(proof_module(design, module))
    with open(stem + ".ys", "w", encoding="utf-8") as file:
        file.write(script)
    run([need("yosys", "yosys"), "-q", stem + ".ys"], stem + ".log")
    try:
        done = subprocess.run(
            [need("yosys-abc", "yosys"), "-q", ABC.format(aig=stem + ".aig")],
            capture_output=True,
            text=True,
            timeout=SECONDS,
            check=False,
        )
        said = done.stdout + done.stderr
        if "not equivalent" in said.lower() or "was asserted" in said or re.search(r"^SATISFIABLE", said, re.M):
            verdict = "different"
        elif "are equivalent" in said or "UNSATISFIABLE" in said:
            verdict = "proved"
        else:
            verdict = "undecided: " + (said.strip().splitlines() or ["ABC printed nothing"])[-1][:100]
    except subprocess.TimeoutExpired:
        verdict = f"undecided: more than {SECONDS} s"
    with open(kept, "w", encoding="utf-8") as file:
        json.dump({"key": key, "verdict": verdict}, file)
    return verdict


def prove(design, only=None):
    """All kinds of block, or those with a module in `only`. Returns {kind's name: verdict}."""
    folder = os.path.join(design.folder, "proofs")
    os.makedirs(folder, exist_ok=True)
    cells = design.library.usable_file(os.path.join(folder, "libraries"))
    chosen = [i for i, m in design.netlist.modules.items() if only is None or m.kind.base in only]
    verdicts = {}
    with concurrent.futures.ThreadPoolExecutor(design.options.jobs) as pool:
        pending = {pool.submit(prove_one, design, i, folder, cells): i for i in chosen}
        for done in concurrent.futures.as_completed(pending):
            name = design.kinds[pending[done]].name
            verdicts[name] = done.result()
            design.phases.note(f"block {len(verdicts)} of {len(chosen)}: {name}: {verdicts[name]}")
    return verdicts
