"""Small blocks, mapped for the tests of the synthesis flow."""
import gzip
import os
import subprocess
import sys
import tempfile
import unittest
from unittest import mock

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.path.insert(0, os.path.join(ROOT, "scripts"))

from synth import elaborate, flow, library, mapping, netlist  # noqa: E402
from synth.memories import MemoryModel  # noqa: E402

# A clock gate as cell libraries have them, for one that has none.
CLOCK_GATE = """cell (ICG) {
  area : 112; clock_gating_integrated_cell : "latch_posedge_precontrol";
  statetable ("CK E", "held") { table : "L L : - : L, L H : - : H, H - : - : N"; }
  pin (held) { direction : internal; internal_node : "held"; }
  pin (CK) { direction : input; clock_gate_clock_pin : true; capacitance : 0.02; }
  pin (E) { direction : input; clock_gate_enable_pin : true; capacitance : 0.01; }
  pin (SE) { direction : input; clock_gate_test_pin : true; capacitance : 0.01; }
  pin (GCK) { direction : output; clock_gate_out_pin : true; state_function : "CK & held"; }
}
"""


def small_design(folder, top, parameters, lib=None):
    """One block mapped alone, as a design."""
    lib = lib or library.Library()
    design = flow.Design(flow.Options(config=top), lib, {}, folder, 4.0, 0.1, top=top)
    design.kinds = elaborate.tree(parameters, folder, top, gated=bool(lib.clock_gate))
    design.memory = MemoryModel(lib)
    mapper = mapping.Mapper(lib, folder, 4.0, 2)
    paths = mapper.map_all([k for k in design.kinds.values() if not k.memory])
    design.netlist = netlist.Netlist(design.kinds, paths, lib, top)
    return design


class SmallBlocks(unittest.TestCase):
    """A folder for each test; what is left in it goes with it."""

    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.addCleanup(subprocess.run, ["rm", "-rf", self.folder], check=False)

    def written(self, name, text):
        path = os.path.join(self.folder, name)
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
        return path

    def gated_library(self):
        """The default library with a clock gate, packed, by a set-up of its own."""
        known = library.setups()
        text = library.Library().text.replace("(osu018_stdcells)", "(with_a_gate)", 1)
        place = text.rindex("}")
        path = os.path.join(self.folder, "gated.lib.gz")
        with gzip.open(path, "wt") as file:
            file.write(text[:place] + CLOCK_GATE + text[place:])
        setup = {**known[library.DEFAULT], "matches": "with_a_gate", "clock_gate": "ICG"}
        with mock.patch.object(library, "setups", lambda: {**known, "gated": setup}):
            return library.Library(path)
