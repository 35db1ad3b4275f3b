#!/usr/bin/env python3
"""Tables of docs/studies/traverser-limits.md and test-widths.md, of the folder that a sweep leaves:

    studies/traverser_table.py binds build/sweeps/traverser    what binds the traverser: for each change of a machine
                                                               what the ceilings of the machine without it predict,
                                                               and what was measured
    studies/traverser_table.py boxes build/sweeps/boxes        boxes in integers of few bits
"""
import json
import sys

PART = "chip.hardware_traverser."
BEAT = "chip.memory.cycles_per_beat"
CACHES = (PART + "node_cache_bytes", PART + "triangle_cache_bytes")
PLACE = ("depth", "units")


def ceilings(row):
    """Of what works: places for rays are taken for as long as the rays wait for the others."""
    return {name: row[name] for name in row if name.startswith("ceilings.") and isinstance(row[name], (int, float))
            and name not in ("ceilings.reached", "ceilings.rays_in_flight")}  # fmt: skip


def cache(row):
    return sum(row[name] for name in CACHES)


def lowest(values):
    name = min(values, key=values.get)
    return name.split(".", 1)[1], values[name]


def predicted(base, row):
    """The lowest ceiling of `base` when those that the change touches are moved by as much as it moves them."""
    moved = ceilings(base)
    moved["ceilings.box_pipes"] *= row[PART + "lanes"] / base[PART + "lanes"]
    moved["ceilings.triangle_pipes"] *= row[PART + "triangle_pipes"] / base[PART + "triangle_pipes"]
    moved["ceilings.memory_port"] *= base[BEAT] / row[BEAT]
    if cache(row) != cache(base):  # what a cache lets through is measured, not known beforehand
        moved["ceilings.memory_port"] *= base["traversal.bytes_a_ray"] / row["traversal.bytes_a_ray"]
    return lowest(moved)


def line(*cells):
    print("{:<6}{:>6}  {:<35}{:<19}{:<21}{:>8}{:>9}".format(*cells))


def change(new, old):
    return f"{new / old - 1:+.1%}"


def differs(row, base):
    return [name for name in (PART + "lanes", BEAT) if row[name] != base[name]] + (
        ["caches"] if cache(row) != cache(base) else []
    )


def label(row):
    return f"{row[PART + 'lanes']} lanes, {cache(row) // 1024} KB, {16 / row[BEAT]:.1f} GB/s"


def show(rows):
    for row in rows:
        place = [str(row["depth"]), str(row["units"])]
        if row["chip.traverser"] == "static":
            line(*place, "static", bound(row), "", "", f"{row['mrays_per_second']:.1f}")
            continue
        bases = [base for base in rows if base["chip.traverser"] != "static" and len(differs(row, base)) == 1
                 and smaller_change(base, row)]  # fmt: skip
        line(*place, label(row), bound(row), "", "", f"{row['mrays_per_second']:.1f}")
        for base in bases:
            name, after = predicted(base, row)
            before = lowest(ceilings(base))[1]
            line("", "", f"  from {label(base)}", "", f"to {name} {after:.0f}",
                 change(after, before), change(row["mrays_per_second"], base["mrays_per_second"]))  # fmt: skip


def smaller_change(base, row):
    """Twice the lanes, half the cache, a tenth of the bandwidth."""
    return (row[PART + "lanes"] == 2 * base[PART + "lanes"] or 2 * cache(row) == cache(base)
            or row[BEAT] == 10 * base[BEAT])  # fmt: skip


def bound(row):
    name, value = lowest(ceilings(row))
    return f"{name} {value:.0f}"


def binds(rows):
    line("depth", "units", "machine", "lowest ceiling", "ceilings predict", "", "measured")
    places = list(dict.fromkeys(tuple(row.get(name) for name in PLACE) for row in rows))
    for place in places:
        show([row for row in rows if tuple(row.get(name) for name in PLACE) == place])


def boxes(rows):
    columns = "{:<6}{:>11}{:>15}{:>12}{:>17}{:>9}"
    print(columns.format("bits", "nodes/ray", "triangles/ray", "box pipes", "triangle pipes",
                         "Mrays/s"))  # fmt: skip
    for row in rows:
        print(columns.format(row[PART + "box_bits"], f"{row['traversal.nodes_a_ray']:.2f}",
                             f"{row['traversal.triangles_a_ray']:.2f}",
                             f"{row['traversal.box_pipes.utilisation']:.1%}",
                             f"{row['traversal.triangle_pipes.utilisation']:.1%}",
                             f"{row['mrays_per_second']:.1f}"))  # fmt: skip


def main():
    tables = {"binds": binds, "boxes": boxes}
    if len(sys.argv) != 3 or sys.argv[1] not in tables:
        sys.exit(__doc__.strip())
    with open(sys.argv[2] + "/table.json", encoding="utf-8") as file:
        tables[sys.argv[1]](json.load(file)["rows"])


main()
