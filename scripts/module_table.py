#!/usr/bin/env python3
"""Checks docs/machine/modules.md against the project: scripts/module_table.py; exit code 1 if a row is
missing or untrue.

Each module of rtl/ has one row: module, without its prefix, Verilog file, C++, tests, proofs. What the C++ column names
is defined in a file that it names, and a class that is called like the module is among them. A test builds a module
that holds the module, and a bench of the module's own is named. The proofs are those with checkers that read the
module.
"""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs/machine/modules.md"
NOTHING = "-"
PREFIX = "rp_"


def modules():
    """Text of each module of rtl/, which is named as its file, by its name without the prefix."""
    return {path.stem.removeprefix(PREFIX): path.read_text() for path in sorted((ROOT / "rtl").glob("*/*.v"))}


def instances(text, names):
    """Which of the modules a Verilog text instantiates."""
    return {name for name in names if re.search(rf"^\s*{PREFIX}{name}\s+(#\(|\w+\s*\()", text, re.M)}


def inside(texts):
    """[module] = the modules that it holds, with those inside them, and itself. ALUs are placed by an included file."""
    placed = (ROOT / "rtl/include/rp_alu_instances.vh").read_text()
    whole = {name: text + (placed if '"rp_alu_instances.vh"' in text else "") for name, text in texts.items()}
    direct = {name: instances(text, texts) for name, text in whole.items()}
    holds = {name: {name} for name in texts}
    while True:
        grown = {name: {name}.union(*(holds[part] for part in direct[name])) for name in texts}
        if grown == holds:
            return holds
        holds = grown


def tests(holds):
    """[test] = the modules of rtl/ that it builds, from the headers of Verilated classes, V<top>_<variant>.h.

    They stand in the test, or in a header of tb/ that it includes. Those of tb/rtl/ run scripts/verilate.sh.
    """

    def whole(path):
        text = path.read_text()
        headers = re.findall(r'#include "((?:unit/\w+|rtl)/\w+\.hpp)"', text)
        return text + "".join((ROOT / "tb" / header).read_text() for header in headers)

    found = {}
    for path in (ROOT / "tb/rtl").glob("*_test.cpp"):
        found[path.stem] = holds["chip" if " --top chip " in whole(path) else "multiprocessor"]
    tops = {**holds}
    for path in (ROOT / "tb/unit").glob("*/*.v"):
        tops[path.stem] = set().union(*(holds[name] for name in instances(path.read_text(), holds)))
    for path in (ROOT / "tb/unit").glob("*/*_test.cpp"):
        text = whole(path)
        included = re.findall(r'#include "V(\w+)\.h"', text)
        built = [[top for top in tops if re.match(rf"{top}(_|$)", each)] for each in included]
        found[path.stem] = set().union(*(tops[max(names, key=len)] for names in built if names))
    return found


def proofs(names):
    """[module] = the proofs of it."""
    found = {name: set() for name in names}
    for path in (ROOT / "tb/proofs/control").glob("*.v"):
        for name in re.search(r"^// @modules(.*)$", path.read_text(), re.M).group(1).split():
            found[name].add(path.stem)
    for path in (ROOT / "tb/proofs").glob("*.sh"):
        for name in set(re.findall(r"rtl/\w+/rp_(\w+)\.v", path.read_text())) & set(names):
            found[name].add(path.stem)
    return found


def camel(name):
    return "".join(word.capitalize() for word in name.split("_"))


def classes():
    """Classes of cpp_model by name, with their files."""
    found = {}
    for path in sorted((ROOT / "cpp_model").rglob("*.hpp")):
        for name in re.findall(r"^(?:template <[^\n]*>\n)?(?:class|struct) (\w+)[^;]*?\{", path.read_text(), re.M):
            found.setdefault(name, path)
    return found


def defines(text, name):
    """Whether C++ text defines a class, a member (in its class or outside) or a function that begins a line."""
    outer, _, last = name.rpartition("::")
    if outer:
        inside_class = re.search(rf"^  \w[^=;()]* [*&]?{last}\(", text, re.M)
        return f"{name}(" in text or (re.search(rf"\bclass {outer}\b", text) and inside_class)
    return re.search(rf"^(class|struct) {name}\b[^;]*\{{|^\w[^=;()]* {name}\(", text, re.M)


def cpp_errors(name, cell, known):
    own = known.get(camel(name))
    if own is not None and f"`{camel(name)}`" not in cell:
        yield f"{name}: the C++ column does not name class {camel(name)} of {own.relative_to(ROOT)}"
    if cell.startswith("none"):
        return
    files = re.findall(r"[\w/]+\.[ch]pp", cell)
    texts = []
    for file in files:
        if (ROOT / "cpp_model" / file).is_file():
            texts.append((ROOT / "cpp_model" / file).read_text())
        else:
            yield f"{name}: there is no cpp_model/{file}"
    named = re.findall(r"`([\w:]+)`", cell)
    if not named or not files:
        yield f"{name}: the C++ column names no class with its file (or 'none: why')"
    for each in named:
        if texts and not any(defines(text, each) for text in texts):
            yield f"{name}: {each} is not defined in {', '.join(files)}"


def row_errors(cells, holds, built, proved, known):
    name, verilog, cpp, test, proof = cells
    if pathlib.PurePath(verilog).name != f"{PREFIX}{name}.v" or not (ROOT / verilog).is_file():
        yield f"{name}: its Verilog file is not {verilog}"
    yield from cpp_errors(name, cpp, known)
    named = set() if test == NOTHING else set(test.split(", "))
    for each in sorted(named - set(built)):
        yield f"{name}: there is no test {each} in tb/rtl or tb/unit"
    for each in sorted(named & set(built)):
        if name not in built[each]:
            yield f"{name}: {each} does not build it"
    own = f"{name}_test"
    if own in built and own not in named:
        yield f"{name}: the row does not name its bench {own}"
    if not named:
        yield f"{name}: the row names no test"
    wanted = ", ".join(sorted(proved[name], key=lambda each: (each != name, each))) or NOTHING
    if proof != wanted:
        yield f"{name}: the proofs are: {wanted}"


def rows():
    for line in PAGE.read_text().splitlines():
        cells = [cell.strip() for cell in line.strip("| ").split(" | ")]
        if line.startswith("| `") and len(cells) == 5:
            yield [cells[0].strip("`")] + cells[1:]


def main():
    texts = modules()
    holds, known = inside(texts), classes()
    built, proved = tests(holds), proofs(texts)
    errors, seen = [], []
    for cells in rows():
        if cells[0] not in texts:
            errors.append(f"{cells[0]}: there is no such module in rtl/")
            continue
        seen.append(cells[0])
        errors += row_errors(cells, holds, built, proved, known)
    errors += [f"{name}: it has no row" for name in texts if name not in seen]
    errors += [f"{name}: it has more than one row" for name in sorted(set(seen)) if seen.count(name) > 1]
    for error in errors:
        print(f"docs/machine/modules.md: {error}", file=sys.stderr)
    if not errors:
        print(f"docs/machine/modules.md: {len(seen)} modules, each with its row; all that the rows name is there")
    return 1 if errors else 0


if __name__ == "__main__":
    sys.exit(main())
