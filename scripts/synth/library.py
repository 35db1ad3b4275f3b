"""A cell library as the flow uses it: the Liberty file, the set-up in constraints/, and what follows from both."""
import fnmatch
import glob
import hashlib
import json
import os

from . import liberty
from .errors import SynthError
from .function import truth

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
DEFAULT_SETUP = os.path.join(ROOT, "constraints", "osu018.json")


class Library:
    """Areas are in um2, capacitances in pF, times in ns."""

    def __init__(self, path=None):
        setup = self._setup(path)
        self.setup = setup
        self.name = setup["name"]
        self.path = setup["liberty"]
        if not os.path.isfile(self.path):
            hint = (
                f": install the Debian package {setup['package']}"
                if "package" in setup
                else ": LIBERTY=path names the file"
            )
            raise SynthError(f"{self.path}: no such Liberty file{hint}")
        self.verilog = setup.get("verilog")
        self.group = liberty.parse(self.path)
        self.cells = liberty.cells(self.group)
        with open(self.path, encoding="utf-8", errors="replace") as file:
            self.text = file.read()
        patterns = setup.get("avoid", [])
        self.avoided = sorted(
            n
            for n, c in self.cells.items()
            if c.kind in ("latch", "other") or any(fnmatch.fnmatchcase(n, p) for p in patterns)
        )
        self.usable = {n: c for n, c in self.cells.items() if n not in self.avoided}
        unit = self.group.attributes.get("capacitive_load_unit", ["1", "pf"])
        self.to_pf = float(unit[0]) * {"ff": 1e-3, "pf": 1.0}[unit[1].lower()]
        self.nand2 = setup.get("nand2") or self._smallest("nand", 2, 0b0111)
        self.inverter = setup.get("inverter") or self._smallest("inverter", 1, 0b01)
        self.buffers = setup.get("buffers") or [self._smallest("buffer", 1, 0b10)]
        self.driver = setup.get("driver") or self.buffers[-1]
        for name in [self.nand2, self.inverter, self.driver, *self.buffers]:
            if name not in self.cells:
                raise SynthError(f"{setup['file']}: the library {self.path} has no cell {name}")
        self.nand2_area = self.cells[self.nand2].area
        # What they say, wherever they lie.
        said = {k: v for k, v in setup.items() if k not in ("file", "liberty", "verilog")}
        self.digest = hashlib.sha256((self.text + json.dumps(said, sort_keys=True)).encode()).hexdigest()

    def _setup(self, path):
        with open(DEFAULT_SETUP, encoding="utf-8") as file:
            default = {**json.load(file), "file": DEFAULT_SETUP}
        if path is None or os.path.abspath(path) == default["liberty"]:
            return default
        # A library without a set-up of its own: everything is found in the Liberty file.
        base = os.path.splitext(os.path.basename(path))[0]
        for file_name in sorted(glob.glob(os.path.join(ROOT, "constraints", "*.json"))):
            with open(file_name, encoding="utf-8") as file:
                setup = json.load(file)
            if fnmatch.fnmatchcase(base, setup.get("matches", "")):
                return {**setup, "liberty": os.path.abspath(path), "file": file_name}
        return {"name": base, "liberty": os.path.abspath(path), "file": path}

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
            raise SynthError(f"{self.path}: the library has no {inputs}-input {what}; add a set-up to constraints/")
        return best.name

    def usable_file(self, folder):
        """The Liberty file without the cells that must not be used; made once."""
        os.makedirs(folder, exist_ok=True)
        path = os.path.join(folder, f"{self.name}-{self.digest[:8]}.lib")
        if not os.path.exists(path):
            new = f"{path}.{os.getpid()}"
            with open(new, "w", encoding="utf-8") as file:
                file.write(liberty.without_cells(self.text, self.avoided))
            os.rename(new, path)
        return path

    def kge(self, area):
        return area / self.nand2_area / 1000

    def pin_pf(self, cell, pin):
        return self.cells[cell].pins[pin].capacitance * self.to_pf
