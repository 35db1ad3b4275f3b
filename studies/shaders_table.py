#!/usr/bin/env python3
"""The table of docs/studies/shader-speed.md, of the folder that a sweep of configs/experiments/shader_sets.json leaves:
studies/shaders_table.py build/sweeps/shader_sets

Of each point Mrays/s, cycles a sample of a pixel, the lowest ceiling, how much of it is reached, and the next one."""
import json
import os
import sys

PREFIX = "ceilings."
# Not limits: what is made of them.
OTHERS = ("reached", "rays_in_flight")


def ceilings(row):
    """Mrays/s by name, the lowest first."""
    found = {name.removeprefix(PREFIX): value for name, value in row.items()
             if name.startswith(PREFIX) and isinstance(value, (int, float))}  # fmt: skip
    return sorted((value, name) for name, value in found.items() if name not in OTHERS)


def main():
    with open(os.path.join(sys.argv[1], "table.json"), encoding="utf-8") as file:
        table = json.load(file)
    width, height = (int(side) for side in table["base"]["size"].split("x"))
    form = "{:<10}{:<9}{:<11}{:>5}{:>9}{:>15}  {:<26}{:>7}  {}"
    print(form.format("scene", "set", "machine", "units", "Mrays/s", "cycles/sample", "lowest ceiling", "of it",
                      "next"))  # fmt: skip
    for row in table["rows"]:
        (lowest, name), (then, following) = ceilings(row)[:2]
        scene = os.path.splitext(os.path.basename(row["scene"]))[0]
        cycles = row["cycles"] / (width * height * row["shaders.samples"])
        print(form.format(scene, row["shaders"], row["config"], row["units"], f"{row['mrays_per_second']:.2f}",
                          f"{cycles:.1f}", f"{name} {lowest:.1f}", f"{row['mrays_per_second'] / lowest:.1%}",
                          f"{following} {then:.1f}"))  # fmt: skip


if __name__ == "__main__":
    main()
