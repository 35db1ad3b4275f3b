"""Proves mutants equivalent. Yosys takes the netlist without a fault and with one apart into gates, leaves out what
nothing reads, and proves that outputs and next state are the same in every state."""
import pathlib
import re
import tempfile

from .errors import Refused, yosys


def prove(folder, numbers):
    """Prints a line a mutant: equivalent, or not proved (only states that cannot be reached may differ, or a program
    could show it). True if all are equivalent."""
    netlist = folder / "netlist.v"
    if not netlist.exists():
        raise Refused(f"{netlist} is not there: make it with make faults SOURCE=mutants")
    bits = int(re.search(r"^ *wire \[(\d+):0\] mutant_i;", netlist.read_text(), re.MULTILINE)[1]) + 1
    proved = True
    with tempfile.TemporaryDirectory() as name:
        work = pathlib.Path(name)

        def gates(number, module):
            """The unit with this fault, as a module of this name."""
            yosys(f"read_verilog {netlist}; hierarchy -top rp_compute_unit; proc; memory_collect; cd rp_compute_unit; "
                  f"connect -set mutant_i {bits}'d{number}; cd; opt_expr; simplemap; opt_expr; opt_clean -purge; "
                  f"rename rp_compute_unit {module}; write_rtlil {work}/{module}.il", work / "log")  # fmt: skip

        gates(0, "gold")
        for number in numbers:
            gates(number, "gate")
            yosys(f"read_rtlil {work}/gold.il; read_rtlil -overwrite {work}/gate.il; equiv_make gold gate equiv; "
                  "hierarchy -top equiv; equiv_struct -icells; equiv_simple -undef -short; "
                  f"tee -o {work}/status equiv_status", work / "log")  # fmt: skip
            equivalent = "Equivalence successfully proven" in (work / "status").read_text()
            print(f"{number}: {'equivalent' if equivalent else 'not proved'}", flush=True)
            proved = proved and equivalent
    return proved
