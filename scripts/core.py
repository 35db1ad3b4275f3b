#!/usr/bin/env python3
"""Writes raypool.core, the FuseSoC description of rtl/, or checks it: scripts/core.py RAYPOOL-TABLES [--check]

Files and parameters come from rtl/ and from the program's table; targets stand here. --check writes nothing and ends
with 1 if the file would change.
"""
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
CORE = ROOT / "raypool.core"


def version():
    return re.search(r"^project\(raypool VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text(), re.M).group(1)


def parameters(tables):
    """Name and default of each, in the order of rtl/compute/rp_multiprocessor.v."""
    text = subprocess.run([tables, "--verilog-parameters"], cwd=ROOT, capture_output=True, text=True, check=True)
    return [("UNITS", 1)] + [tuple(line.split("=")) for line in text.stdout.split()]


def names(pattern):
    return sorted(str(path.relative_to(ROOT)) for path in (ROOT / "rtl").rglob(pattern))


def core(tables):
    yield "CAPI=2:"
    yield "# The hardware for FuseSoC, made from rtl/ by scripts/core.py; a test compares. Do not edit."
    yield f'name: "::raypool:{version()}"'
    yield "description: ray-tracing GPU, 1, 2 or 4 SIMT compute units behind one set of ports, in Verilog-2005"
    yield "filesets:"
    yield "  rtl:"
    yield "    file_type: verilogSource-2005"
    yield "    files:"
    for name in names("*.vh"):
        yield f"      - {name}: {{is_include_file: true}}"
    for name in names("*.v"):
        yield f"      - {name}"
    yield "  waivers:"
    yield "    file_type: vlt"
    yield "    files:"
    for name in names("*.vlt"):
        yield f"      - {name}"
    known = parameters(tables)
    listed = ", ".join(name for name, _ in known)
    yield "targets:"
    yield "  default: &default"
    yield '    filesets: [rtl, "tool_verilator ? (waivers)"]'
    yield "    toplevel: rp_multiprocessor"
    yield f"    parameters: [{listed}]"
    yield "  lint:"
    yield "    <<: *default"
    yield "    default_tool: verilator"
    yield "    tools:"
    yield "      verilator:"
    yield "        mode: lint-only"
    yield "        verilator_options: [-Wall, --default-language, 1364-2005]"
    yield "parameters:"
    for name, value in known:
        yield f"  {name}: {{datatype: int, default: {value}, paramtype: vlogparam}}"


def main():
    text = "\n".join(core(str(pathlib.Path(sys.argv[1]).resolve()))) + "\n"
    if "--check" in sys.argv[2:]:
        if not CORE.exists() or CORE.read_text() != text:
            sys.exit("raypool.core does not fit rtl/: make isa writes it")
        return
    if not CORE.exists() or CORE.read_text() != text:
        CORE.write_text(text)
        print(f"wrote {CORE.name}")


if __name__ == "__main__":
    main()
