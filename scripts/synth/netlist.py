"""The mapped netlist of a configuration: read from the kept results of mapping, measured,
and written as one hierarchical Verilog file.
"""
import json
import re
from collections import Counter
from dataclasses import dataclass, field

from .errors import SynthError

_PLAIN = re.compile(r"[^A-Za-z0-9_]+")


def plain(name):
    """A name without the characters that need escaping: gen_lane[3].lane becomes gen_lane_3_lane."""
    return _PLAIN.sub("_", name).strip("_")


@dataclass
class Module:
    """One kind of block as mapped. A net is an integer or one of the constants "0", "1"."""

    name: str
    kind: object
    ports: list  # (name, direction, nets low bit first)
    gates: dict = field(default_factory=dict)  # instance -> (library cell, {pin: net})
    blocks: dict = field(default_factory=dict)  # instance -> (identity, {port: [nets]})
    names: dict = field(default_factory=dict)  # net -> text in Verilog
    originals: dict = field(default_factory=dict)  # instance -> its name in the RTL
    last: int = 0  # highest net number

    def fresh(self, stem):
        """A new net."""
        self.last += 1
        self.names[self.last] = f"{stem}_{self.last}"
        return self.last


class Netlist:
    """All modules by identity; `top` is where instances begin. Memories are kinds without a module."""

    def __init__(self, kinds, paths, library, top):
        self.kinds = kinds
        self.library = library
        self.top = top
        self.modules = {}
        for identity, path in paths.items():
            self.modules[identity] = self._read(kinds[identity], path)

    def _read(self, kind, path):
        with open(path, encoding="utf-8") as file:
            data = json.load(file)
        module = Module(kind.name, kind, [])
        known = {"0": "0", "1": "1", "x": "0", "z": "0"}

        def net(bit):
            return known[bit] if isinstance(bit, str) else bit

        taken = set()
        for name, port in data["ports"].items():
            nets = [net(b) for b in port["bits"]]
            module.ports.append((name, port["direction"], nets))
            taken.add(name)
        self._name_nets(module, data, taken)
        used = set(taken) | {n.split("[")[0] for n in module.names.values()}

        def unique(stem):
            candidate, count = stem, 1
            while candidate in used:
                count += 1
                candidate = f"{stem}_{count}"
            used.add(candidate)
            return candidate

        serial = 0
        for name, cell in data["cells"].items():
            if cell["type"] in self.kinds:
                ports = {p: [net(b) for b in bits] for p, bits in cell["connections"].items()}
                label = unique(plain(name))
                module.blocks[label] = (cell["type"], ports)
                module.originals[label] = name
                continue
            known_cell = self.library.cells.get(cell["type"])
            if known_cell is None:
                raise SynthError(
                    f"{kind.name}: block {name} is a {cell['type']}, which is neither a cell of the library nor a "
                    "listed memory"
                )
            pins = {p: net(bits[0]) for p, bits in cell["connections"].items()}
            if known_cell.kind == "flop":
                output = known_cell.outputs()[0].name
                label = unique(plain(module.names.get(pins.get(output), "unnamed")) + "_reg")
            else:
                serial += 1
                label = unique(f"g{serial}")
            module.gates[label] = (cell["type"], pins)
        return module

    @staticmethod
    def _name_nets(module, data, taken):
        """Every net gets the name of a port bit, else of a named register or wire, else a number."""
        for wanted in ("input", "output"):
            for name, direction, nets in module.ports:
                if direction != wanted:
                    continue
                for i, bit in enumerate(nets):
                    if not isinstance(bit, str):
                        module.names.setdefault(bit, f"{name}[{i}]" if len(nets) > 1 else name)
        used = set(taken)
        numbers = [
            b
            for c in data["cells"].values()
            for bits in c["connections"].values()
            for b in bits
            if not isinstance(b, str)
        ]
        module.last = max([*numbers, *module.names, 1])
        for name in sorted(data["netnames"], key=lambda n: (not n.endswith("_q"), "." in n, len(n), n)):
            bits = data["netnames"][name]["bits"]
            stem = plain(name)
            for i, bit in enumerate(bits):
                if isinstance(bit, str) or bit in module.names:
                    continue
                label = f"{stem}_{i}" if len(bits) > 1 else stem
                if label in used:
                    label = f"{label}_n{bit}"
                used.add(label)
                module.names[bit] = label
        for bit in numbers:
            if bit not in module.names:
                module.names[bit] = f"n{bit}"

    # ---- measures

    def gate_count(self, identity):
        """Library cells directly in a kind of block, by cell name."""
        return Counter(cell for cell, _ in self.modules[identity].gates.values())

    def own_area(self, identity):
        """um2 of the cells directly in a kind of block."""
        return sum(self.library.cells[c].area * n for c, n in self.gate_count(identity).items())

    def own_clocked_area(self, identity):
        """um2 of its flip-flops and clock gates."""
        count, cells = self.gate_count(identity), self.library.cells
        return sum(cells[c].area * n for c, n in count.items() if cells[c].kind in ("flop", "clock_gate"))

    def own_flops(self, identity):
        return sum(n for c, n in self.gate_count(identity).items() if self.library.cells[c].kind == "flop")

    def instances(self, identity=None, path=()):
        """Every instance of a block, depth first: (path as a tuple of instance names, identity). Memories included."""
        identity = identity or self.top
        yield path, identity
        if identity in self.modules:
            for name, (child, _) in self.modules[identity].blocks.items():
                yield from self.instances(child, path + (name,))

    # ---- Verilog

    def write(self, path):
        """One Verilog file with a module for each kind; memories are left out."""
        with open(path, "w", encoding="utf-8") as file:
            for module in self.modules.values():
                self._write_module(file, module)

    def _write_module(self, file, module):
        names = module.names

        def text(net):
            return f"1'b{net}" if isinstance(net, str) else names[net]

        file.write(f"module {module.name} ({', '.join(p[0] for p in module.ports)});\n")
        for name, direction, nets in module.ports:
            width = f"[{len(nets) - 1}:0] " if len(nets) > 1 else ""
            file.write(f"  {direction} {width}{name};\n")
        ports = {p[0] for p in module.ports}
        wires = [n for n in names.values() if n.split("[")[0] not in ports]
        for i in range(0, len(wires), 12):
            file.write(f"  wire {', '.join(wires[i:i + 12])};\n")
        for name, direction, nets in module.ports:
            if direction == "output":
                for i, net in enumerate(nets):
                    label = f"{name}[{i}]" if len(nets) > 1 else name
                    if text(net) != label:
                        file.write(f"  assign {label} = {text(net)};\n")
        for label, (cell, pins) in module.gates.items():
            file.write(f"  {cell} {label} ({', '.join(f'.{p}({text(n)})' for p, n in pins.items())});\n")
        for label, (identity, connections) in module.blocks.items():
            child = self.kinds[identity]
            listed = []
            for port, nets in connections.items():
                joined = ", ".join(text(n) for n in reversed(nets))
                listed.append(f".{port}({'{' + joined + '}' if len(nets) > 1 else joined})")
            file.write(f"  {child.name} {label} ({', '.join(listed)});\n")
        file.write("endmodule\n\n")
