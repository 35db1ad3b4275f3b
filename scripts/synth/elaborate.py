"""What a configuration consists of: its Verilog parameters, and the tree of modules with the parameters of each."""
import glob
import json
import os
import subprocess
from collections import Counter
from dataclasses import dataclass, field

from .errors import SynthError, need, run
from .library import ROOT

PREFIX = "rp_"  # of all modules in the Verilog; reports are without
MEMORIES = ("ram_1rw", "ram_1r1w", "ram_2r1w")


@dataclass
class Kind:
    """One module with one set of parameters. `identity` is Yosys' name for it, the type of its instances."""

    identity: str
    base: str  # the module, without the prefix
    parameters: dict  # name -> (bits as text)
    ports: dict  # name -> (direction, width)
    children: dict  # instance -> identity
    name: str = ""  # unique and fit for Verilog; the base name where that is enough
    bits: int = 0  # at its cells' pins before mapping: how large it is
    wires: dict = field(default_factory=dict)  # of the top: name -> what drives each bit, as drivers() has it

    def value(self, parameter):
        return int(self.parameters[parameter], 2)

    @property
    def memory(self):
        return self.base in MEMORIES


def in_words(kinds):
    """Kinds for a line of progress: modules, how many kinds of each where they are several; names have parameters."""
    counted = Counter(kind.base for kind in kinds)
    return ", ".join(base if n == 1 else f"{base} ({n} kinds)" for base, n in sorted(counted.items()))


def rtl_files():
    return sorted(glob.glob(os.path.join(ROOT, "rtl", "*", "*.v")))


def text_of(texts, base):
    """Of rtl_texts() that of a module."""
    return next(text for path, text in texts.items() if os.path.basename(path) == f"{PREFIX}{base}.v")


def defines(gated):
    """The Verilog that is synthesised: Booth trees in place of products; rp_free_running.vh describes what clock gates
    change.
    """
    return "-DSYNTHESIS" if gated else "-DSYNTHESIS -DNO_CLOCK_GATES"


def read_rtl(gated):
    """Yosys: reads all of rtl/, for cells with clock gates or without."""
    return f"read_verilog {defines(gated)} -I{ROOT}/rtl/include {' '.join(rtl_files())}"


def rtl_texts():
    """Every text the RTL is made of, by path below the project."""
    texts = {}
    for path in rtl_files() + sorted(glob.glob(os.path.join(ROOT, "rtl", "include", "*.vh"))):
        with open(path, encoding="utf-8") as file:
            texts[os.path.relpath(path, ROOT)] = file.read()
    return texts


def raypool():
    program = os.environ.get("RAYPOOL", os.path.join(ROOT, os.environ.get("BUILD", "build"), "raypool"))
    if not os.access(program, os.X_OK):
        raise SynthError(f"{program} is not there: build it with make program")
    return program


def ask(*arguments):
    """What raypool config prints."""
    done = subprocess.run([raypool(), "config", *arguments], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise SynthError((done.stderr or done.stdout).strip())
    return done.stdout


def configuration(name, units=0):
    """The Verilog parameters of a configuration, as raypool prints them: of the unit, or of a chip of so many units."""
    chip = ["--chip", "--units", str(units)] if units else []
    return dict(line.split("=") for line in ask(name, "--verilog-parameters", *chip).split())


def with_fields(name, fields, folder):
    """A file of the configuration with these fields set, under the name that raypool gives it."""
    text = ask(name, *(word for field in fields for word in ("--set", field)), "--json")
    os.makedirs(folder, exist_ok=True)
    path = os.path.join(folder, json.loads(text)["name"] + ".json")
    new = f"{path}.{os.getpid()}"
    with open(new, "w", encoding="utf-8") as file:
        file.write(text)
    os.rename(new, path)
    return path


def tree(parameters, folder, top, gated=False):
    """All kinds of module from `top` down, by identity; that of the top is its name."""
    os.makedirs(folder, exist_ok=True)
    script, result = os.path.join(folder, "elaborate.ys"), os.path.join(folder, "elaborate.json")
    chosen = " ".join(f"-chparam {n} {v}" for n, v in parameters.items())
    with open(script, "w", encoding="utf-8") as file:
        file.write(f"{read_rtl(gated)}\nhierarchy -check -top {PREFIX}{top} {chosen}\n")
        file.write(f"delete */p:*\nwrite_json {result}\n")
    run([need("yosys", "yosys"), "-q", script], os.path.join(folder, "elaborate.log"))
    with open(result, encoding="utf-8") as file:
        modules = json.load(file)["modules"]
    kinds = {}
    for identity, module in modules.items():
        if "top" in module["attributes"]:
            identity = top
        base = module["attributes"].get("hdlname", "\\" + identity).lstrip("\\").removeprefix(PREFIX)
        ports = {n: (p["direction"], len(p["bits"])) for n, p in module["ports"].items()}
        children = {n: c["type"] for n, c in module["cells"].items() if c["type"] in modules}
        bits = sum(len(b) for c in module["cells"].values() for b in c["connections"].values())
        kinds[identity] = Kind(identity, base, module.get("parameter_default_values", {}), ports, children, bits=bits)
        if identity == top:
            kinds[identity].wires = drivers(module, modules)
    by_base = {}
    for kind in kinds.values():
        by_base.setdefault(kind.base, []).append(kind)
    for base, group in by_base.items():
        for kind in group:
            if kind.memory:
                kind.name = f"{base}_{kind.value('DEPTH')}x{kind.value('WIDTH')}"
            else:
                kind.name = base if len(group) == 1 else base + distinguishing(kind, group)
    return kinds


def drivers(module, modules):
    """By name of a module's wires what drives each bit: (block, its port, bit), ("", input, bit) or the constants "0"
    and "1"; None where that is logic of its own.
    """
    found = {"0": "0", "1": "1"}
    ends = [("", name, port["bits"]) for name, port in module["ports"].items() if port["direction"] == "input"]
    for block, cell in module["cells"].items():
        for name, port in modules.get(cell["type"], {"ports": {}})["ports"].items():
            if port["direction"] == "output":
                ends.append((block, name, cell["connections"].get(name, [])))
    for block, name, bits in ends:
        for place, bit in enumerate(bits):
            found.setdefault(bit, (block, name, place))
    return {name: [found.get(bit) for bit in net["bits"]] for name, net in module["netnames"].items()}


def distinguishing(kind, group):
    """A suffix from the parameters in which a module's kinds differ: _stages2_width8."""
    parts = [
        f"_{n.lower()}{int(v, 2)}"
        for n, v in sorted(kind.parameters.items())
        if any(other.parameters.get(n) != v for other in group)
    ]
    return "".join(parts) or "_" + kind.identity[-6:]
