#!/usr/bin/env python3
"""Checks what the C++ sources include: nothing of a layer above their own, nor do folders need each other in a circle.

Layers, lowest first: cpp_model, sim; then bench and tb, which nothing uses.
scripts/layers.py [ROOT]: of another checkout. cmake/layers.cmake checks the same of what is linked.
"""
import graphlib
import pathlib
import re
import sys

LAYERS = {"cpp_model": 0, "sim": 1, "bench": 2, "tb": 2}
INCLUDE = re.compile(r'^\s*#\s*include\s+"([^"]+)"', re.M)


def includes(root):
    """(file, what it includes) of the project, as paths below its root. Generated headers are nobody's."""
    for layer in LAYERS:
        for path in sorted((root / layer).rglob("*.[ch]pp")):
            for name in INCLUDE.findall(path.read_text()):
                places = [path.parent / name] + [root / folder / name for folder in LAYERS]
                found = next((place.resolve() for place in places if place.is_file()), None)
                if found:
                    yield path.relative_to(root), found.relative_to(root)


def is_test(path):
    return path.stem.endswith("_test") or path.stem.startswith("test_")


def faults(pairs):
    for path, included in pairs:
        if path.parts[0] != included.parts[0] and LAYERS[path.parts[0]] <= LAYERS[included.parts[0]]:
            yield f"{path} includes {included}: {path.parts[0]} may not use {included.parts[0]}"
    needs = {}
    for path, included in pairs:
        if not is_test(path) and path.parent != included.parent:
            needs.setdefault(str(path.parent), set()).add(str(included.parent))
    try:
        graphlib.TopologicalSorter(needs).prepare()
    except graphlib.CycleError as error:
        yield "folders that need each other: " + " <- ".join(error.args[1])


def main():
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parent.parent).resolve()
    pairs = list(includes(root))
    found = list(faults(pairs))
    for fault in found:
        print(f"layers.py: {fault}", file=sys.stderr)
    if found or not pairs:
        sys.exit(1)
    print(f"layers.py: {len(pairs)} includes, each of the file's own layer or one below")


main()
