"""A cell library as the flow uses it: the Liberty file, the set-up in constraints/libraries, and what follows from
both.
"""
import fnmatch
import glob
import gzip
import hashlib
import json
import os
import zlib

from . import liberty
from .errors import SynthError
from .function import truth

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
BUILD = os.path.join(ROOT, os.environ.get("BUILD", "build"), "synth")
SETUPS = os.path.join(ROOT, "constraints", "libraries")
DEFAULT = "osu018"

# What the flow loads nets with, in input pins of the library's inverter: every output of a block while it is mapped
# alone, and of fanout.py what a driver may see directly and what a buffer may drive.
LOADS = {"output": 3.2, "direct": 6.4, "cluster": 12.8}


def setups():
    """Every set-up, by the library's name."""
    found = {}
    for path in sorted(glob.glob(os.path.join(SETUPS, "*.json"))):
        with open(path, encoding="utf-8") as file:
            found[os.path.basename(path).removesuffix(".json")] = json.load(file)
    return found


def text_of(path):
    """A Liberty file's text, unpacked."""
    try:
        with gzip.open(path, "rb") if path.endswith(".gz") else open(path, "rb") as file:
            return file.read().decode("utf-8", errors="replace")
    except FileNotFoundError:
        known = setups()
        if path == known[DEFAULT]["liberty"]:
            hint = f"{path}: no such Liberty file: {known[DEFAULT]['where']}"
        elif path in known:
            hint = f"LIBERTY={path}: name the file, the project ships no library; {known[path]['where']}"
        else:
            names = ", ".join(known)
            hint = f"LIBERTY={path}: no such Liberty file; LIBERTY=NAME prints where to get that of {names}"
        raise SynthError(hint) from None
    except (OSError, EOFError, zlib.error) as error:
        raise SynthError(f"LIBERTY={path}: the Liberty file cannot be read ({error})") from error


def keep(path, text):
    """Writes a file that others may be writing too."""
    if not os.path.exists(path):
        os.makedirs(os.path.dirname(path), exist_ok=True)
        new = f"{path}.{os.getpid()}"
        with open(new, "w", encoding="utf-8") as file:
            file.write(text)
        os.rename(new, path)
    return path


class Library:
    """Areas are in um2, capacitances in pF, times in ns."""

    def __init__(self, path=None):
        self.path = path or setups()[DEFAULT]["liberty"]
        self.text = text_of(self.path)
        self.group = liberty.parse(self.text, self.path)
        self.cells = liberty.cells(self.group)
        self.name, self.setup = self._find_setup()
        self.verilog = self.setup.get("verilog")
        self._name_cells()
        unit = self.group.attributes.get("capacitive_load_unit", ["1", "pf"])
        self.to_pf = float(unit[0]) * {"ff": 1e-3, "pf": 1.0}[unit[1].lower()]
        self.nand2_area = self.cells[self.nand2].area
        # What OpenSTA puts on every net unasked; ABC puts nothing there.
        self.wire_load = self.group.attributes.get("default_wire_load", "")
        inverter_pf = self.pin_pf(self.inverter, self.cells[self.inverter].inputs()[0].name)
        self.loads_pf = {
            **{place: pins * inverter_pf for place, pins in LOADS.items()},
            **{place: ff / 1000 for place, ff in self.setup.get("loads_ff", {}).items()},
        }
        # Their content, wherever they lie.
        said = {k: v for k, v in self.setup.items() if k not in ("liberty", "verilog", "where")}
        self.digest = hashlib.sha256((self.text + json.dumps(said, sort_keys=True)).encode()).hexdigest()

    def _find_setup(self):
        """The library's name and set-up: that which its own name calls for, else the file's name and nothing."""
        for name, setup in setups().items():
            if fnmatch.fnmatchcase(self.group.arguments[0], setup["matches"]):
                return name, setup
        return os.path.basename(self.path).removesuffix(".gz").removesuffix(".lib"), {}

    def _name_cells(self):
        """Which cells are used, and for what; what no set-up names is found by its function."""
        setup = self.setup
        self.clock_gate = setup.get("clock_gate")
        patterns = setup.get("avoid", [])
        self.avoided = sorted(
            n
            for n, c in self.cells.items()
            if n != self.clock_gate
            and (c.kind not in ("gate", "flop") or any(fnmatch.fnmatchcase(n, p) for p in patterns))
        )
        self.usable = {n: c for n, c in self.cells.items() if n not in self.avoided}
        self.nand2 = setup.get("nand2") or self._smallest("nand", 2, 0b0111)
        self.inverter = setup.get("inverter") or self._smallest("inverter", 1, 0b01)
        self.driver = setup.get("driver") or self._smallest("buffer", 1, 0b10)
        for name in [self.nand2, self.inverter, self.driver, *([self.clock_gate] if self.clock_gate else [])]:
            if name not in self.usable:
                raise SynthError(
                    f"{SETUPS}/{self.name}.json: the library {self.path} has no cell {name} that may be used"
                )

    @property
    def gate_output(self):
        """The clock gate's pin that registers hang on."""
        return next(n for n, p in self.cells[self.clock_gate].pins.items() if p.gate == "output")

    def _smallest(self, what, inputs, table):
        best = None
        for cell in self.usable.values():
            outputs = cell.outputs()
            if cell.kind != "gate" or len(outputs) != 1 or len(cell.inputs()) != inputs:
                continue
            if truth(outputs[0].function, [p.name for p in cell.inputs()]) == table and (
                best is None or cell.area < best.area
            ):
                best = cell
        if best is None:
            raise SynthError(
                f"{self.path}: the library has no {inputs}-input {what}; add a set-up to constraints/libraries"
            )
        return best.name

    def _file(self, folder, what, text):
        return keep(os.path.join(folder, f"{self.name}-{what}{self.digest[:8]}.lib"), text)

    def whole_file(self):
        """The Liberty file as a tool can read it."""
        if not self.path.endswith(".gz"):
            return self.path
        return self._file(os.path.join(BUILD, "libraries"), "whole-", self.text)

    def usable_file(self, folder):
        """The Liberty file without the cells that must not be used; made once."""
        return self._file(folder, "", liberty.without_cells(self.text, self.avoided))

    def kge(self, area):
        return area / self.nand2_area / 1000

    def pin_pf(self, cell, pin):
        return self.cells[cell].pins[pin].capacitance * self.to_pf
