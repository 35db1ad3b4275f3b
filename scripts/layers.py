#!/usr/bin/env python3
"""Checks what the sources use: nothing of a folder that theirs may not use, nor do folders need each other in a circle.

C++ by what it includes, Python by what it imports: what simulates, verifies and synthesises the machine needs nothing
of studies/. scripts/layers.py [ROOT]: of another checkout. cmake/layers.cmake checks the same of what is linked.
"""
import graphlib
import pathlib
import re
import sys

# Each folder with the others that it may use.
MAY_USE = {
    "cpp_model": (),
    "sim": ("cpp_model",),
    "bench": ("cpp_model", "sim"),
    "tb": ("cpp_model", "sim"),
    "scripts": (),
    "studies": ("cpp_model", "sim", "scripts"),
    "program": ("cpp_model", "sim", "studies"),
}
INCLUDE = re.compile(r'^\s*#\s*include\s+"([^"]+)"', re.M)
IMPORT = re.compile(r"^\s*(?:from|import)\s+([\w.]+)", re.M)


def includes(root):
    """(file, what it includes) of the project, as paths below its root. Generated headers are in no layer."""
    for layer in MAY_USE:
        for path in sorted((root / layer).rglob("*.[ch]pp")):
            for name in INCLUDE.findall(path.read_text()):
                places = [path.parent / name] + [root / folder / name for folder in MAY_USE]
                found = next((place.resolve() for place in places if place.is_file()), None)
                if found:
                    yield path.relative_to(root), found.relative_to(root)


def imports(root):
    """The same of Python's modules."""
    for layer in MAY_USE:
        for path in sorted((root / layer).rglob("*.py")):
            for name in IMPORT.findall(path.read_text()):
                module = name.replace(".", "/")
                places = [path.parent] + [root / folder for folder in MAY_USE] + [root / layer / "tests"]
                files = [place / f"{module}{end}" for place in places for end in (".py", "/__init__.py")]
                found = next((file for file in files if file.is_file()), None)
                if found:
                    yield path.relative_to(root), found.relative_to(root)


def is_test(path):
    return path.stem.endswith("_test") or path.stem.startswith("test_")


def faults(pairs):
    for path, used in pairs:
        own, other = path.parts[0], used.parts[0]
        if own != other and other not in MAY_USE[own]:
            yield f"{path} uses {used}: {own} may not use {other}"
    needs = {}
    for path, used in pairs:
        if path.suffix != ".py" and not is_test(path) and path.parent != used.parent:
            needs.setdefault(str(path.parent), set()).add(str(used.parent))
    try:
        graphlib.TopologicalSorter(needs).prepare()
    except graphlib.CycleError as error:
        yield "folders that need each other: " + " <- ".join(error.args[1])


def main():
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parent.parent).resolve()
    included, imported = list(includes(root)), list(imports(root))
    found = list(faults(included + imported))
    for fault in found:
        print(f"layers.py: {fault}", file=sys.stderr)
    if found or not included:
        sys.exit(1)
    print(f"layers.py: {len(included)} includes and {len(imported)} imports, each of what the file's folder may use")


main()
