"""Reads the parts of a Liberty file that the flow needs: cells, areas, pins with their capacitance and function,
what is a flip-flop.
"""
import re
from dataclasses import dataclass, field

from .errors import SynthError

_TOKEN = re.compile(r'"(?:[^"\\]|\\.)*"|/\*.*?\*/|\\\n|[{}();:,]|[^\s{}();:,"]+', re.S)


@dataclass
class Group:
    """kind (arguments) { attributes; groups }"""

    kind: str
    arguments: list
    attributes: dict = field(default_factory=dict)
    groups: list = field(default_factory=list)

    def all(self, kind):
        return [g for g in self.groups if g.kind == kind]

    def number(self, name, default=0.0):
        try:
            return float(self.attributes.get(name, default))
        except ValueError:
            return default


def _tokens(text):
    for match in _TOKEN.finditer(text):
        token = match.group()
        if token.startswith("/*") or token == "\\\n":
            continue
        yield token[1:-1] if token.startswith('"') else token


def parse(text, path):
    """The library group in the text of a Liberty file; its path is for messages."""
    tokens = list(_tokens(text))
    root = Group("file", [])
    stack, i, end = [root], 0, len(tokens)
    while i < end:
        token = tokens[i]
        if token == "}":
            if len(stack) == 1:
                raise SynthError(f"{path}: not a Liberty file (a closing brace too many)")
            stack.pop()
            i += 1
        elif token in (";", ","):
            i += 1
        elif i + 1 < end and tokens[i + 1] == ":":
            value, i = [], i + 2
            # Some files leave out the semicolon: what follows begins with a name and a colon or a parenthesis.
            while i < end and tokens[i] not in (";", "}") and not (value and tokens[i + 1 : i + 2] in ([":"], ["("])):
                value.append(tokens[i])
                i += 1
            stack[-1].attributes[token] = " ".join(value)
        elif i + 1 < end and tokens[i + 1] == "(":
            arguments, i = [], i + 2
            while i < end and tokens[i] != ")":
                if tokens[i] != ",":
                    arguments.append(tokens[i])
                i += 1
            i += 1
            if i < end and tokens[i] == "{":
                group = Group(token, arguments)
                stack[-1].groups.append(group)
                stack.append(group)
                i += 1
            else:
                stack[-1].attributes[token] = arguments
        else:
            i += 1
    libraries = root.all("library")
    if not libraries:
        raise SynthError(f"{path}: not a Liberty file (it has no library group)")
    return libraries[0]


@dataclass
class Pin:
    name: str
    direction: str
    capacitance: float  # in the library's unit
    function: str
    clock: bool
    gate: str  # of a clock gate: "clock", "enable", "test" or "output"


@dataclass
class Cell:
    name: str
    area: float
    leakage: float
    pins: dict
    kind: str  # "gate", "flop", "latch", "clock_gate", "other" (no function)
    sequential: Group  # the ff or latch group, or None

    def inputs(self):
        return [p for p in self.pins.values() if p.direction == "input"]

    def outputs(self):
        return [p for p in self.pins.values() if p.direction == "output"]

    def shows_state(self, pin):
        """Whether an output of a flip-flop is its state; else it is the inverse."""
        return self.pins[pin].function.strip("() ") == self.sequential.arguments[0]


# What Liberty calls the pins of a clock gate.
GATE_PINS = [
    ("clock", "clock_gate_clock_pin"),
    ("enable", "clock_gate_enable_pin"),
    ("test", "clock_gate_test_pin"),
    ("output", "clock_gate_out_pin"),
]


def cells(library):
    """All cells of a library, by name."""
    found = {}
    for group in library.all("cell"):
        pins = {}
        for pin in group.all("pin"):
            name = pin.arguments[0]
            capacitance = pin.number("capacitance")
            gate = next((role for role, mark in GATE_PINS if pin.attributes.get(mark) == "true"), "")
            pins[name] = Pin(
                name,
                pin.attributes.get("direction", "input"),
                capacitance,
                pin.attributes.get("function", ""),
                pin.attributes.get("clock", "false") == "true" or gate == "clock",
                gate,
            )
        sequential = (group.all("ff") or group.all("latch") or [None])[0]
        kind = "gate"
        if group.attributes.get("clock_gating_integrated_cell", "").startswith("latch_posedge"):
            kind = "clock_gate"
        elif group.all("ff"):
            kind = "flop"
        elif group.all("latch") or group.all("statetable"):
            kind = "latch"
        elif not any(p.function for p in pins.values()) or any("three_state" in p.attributes for p in group.all("pin")):
            kind = "other"
        found[group.arguments[0]] = Cell(
            group.arguments[0], group.number("area"), group.number("cell_leakage_power"), pins, kind, sequential
        )
    if not found:
        raise SynthError("the Liberty file has no cell")
    return found


def without_cells(text, names):
    """The text of a Liberty file without the named cells."""
    for name in names:
        match = re.search(r'\bcell\s*\(\s*"?' + re.escape(name) + r'"?\s*\)\s*\{', text)
        if match is None:
            continue
        depth, end = 1, match.end()
        while depth:
            brace = re.compile(r"[{}]").search(text, end)
            if brace is None:
                raise SynthError(f"the Liberty file ends inside cell {name}")
            depth += 1 if brace.group() == "{" else -1
            end = brace.end()
        text = text[: match.start()] + text[end:]
    return text
