#!/usr/bin/env python3
"""How far estimates are off: random machines draw random frames with engines `model` and `estimate`.

    studies/estimates.py [--machines N] [--seed S] [--file NAME=PATH] [REPORT...]

Prints of each traverser the errors in cycles, how many 95% intervals contain the cycles, and of how many pairs of runs
with the same frame, more than 5% apart, the estimate finds the faster. REPORT, a report.json of engine model, rtl or
lockstep, or a folder with some below it, takes the place of the random machines: each command is run again with engine
estimate. `make estimates` calls it. RAYPOOL names the program, default raypool in the build folder (BUILD).
"""
import argparse
import concurrent.futures
import itertools
import json
import os
import pathlib
import random
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
RAYPOOL = os.path.abspath(os.environ.get("RAYPOOL", ROOT / os.environ.get("BUILD", "build") / "raypool"))
APART = 0.05  # of two runs, so that it matters which is the faster
SCENES = ("cornell", "room")

# (how often, what is set, to one of these); of `hardware` and `static` only behind it.
SETTINGS = (
    (0.5, "chip.policy", ("fill",)),
    (0.3, "triples", ("true",)),
    (0.3, "kernel_overlap", ("true",)),
    (0.3, "intersection_words", ("16",)),
    (0.3, "arithmetic.fma", ("true",)),
    (0.3, "alus.flt.count", ("2",)),
    (0.2, "alus.slw.latency", ("4",)),
    (0.3, "chip.ray_pool.pipelined", ("true",)),
    (0.3, "chip.intersection_pool.pipelined", ("true",)),
    (0.3, "chip.culling", ("true",)),
    (0.3, "chip.shading", ("traverser",)),
    (0.3, "chip.tile_order", ("hilbert",)),
    (0.2, "chip.held_limit", ("256",)),
    (0.2, "chip.launch_ahead", ("false",)),
    (0.2, "chip.memory.latency", ("60", "240")),
    (0.3, "chip.memory.cycles_per_beat", ("1", "4")),
)
OF_TRAVERSER = {
    "hardware": (
        (0.5, "chip.hardware_traverser.lanes", ("2", "8")),
        (0.5, "chip.hardware_traverser.rays", ("32", "64", "256", "512")),
        (0.3, "chip.hardware_traverser.triangle_pipes", ("1",)),
        (0.4, "chip.hardware_traverser.node_cache_bytes", ("8192", "16384", "262144")),
        (0.4, "chip.hardware_traverser.triangle_cache_bytes", ("8192", "16384", "262144")),
    ),
    "static": ((0.3, "chip.static_traverser.batch", ("32", "128")),),
}


def random_command(chance, files):
    """The options of a random machine and frame."""
    scene = chance.choice(SCENES + tuple(files))
    warps, lanes = chance.choice((2, 4, 8, 16)), chance.choice((2, 4, 8, 16))
    size = chance.choice((64, 96, 128))
    traverser = chance.choice(("hardware", "hardware", "static"))
    settings = [
        f"{name}={chance.choice(values)}"
        for share, name, values in SETTINGS + OF_TRAVERSER[traverser]
        if chance.random() < share
    ]
    return ["sim", files.get(scene, scene), "--config", f"{warps}w{lanes}c", "--units", str(chance.choice((1, 2, 4))),
            "--depth", str(chance.choice((1, 3, 5))), "--size", f"{size}x{size}", "--traverser", traverser,
            *(["--set", " ".join(settings)] if settings else [])]  # fmt: skip


def draw(command, engine, folder):
    """Its report."""
    done = subprocess.run([RAYPOOL, *command, "--engine", engine, "--json", "--out", folder], text=True, cwd=ROOT,
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE, check=False)  # fmt: skip
    if done.returncode != 0:
        sys.exit(f"estimates.py: raypool {' '.join(command)} --engine {engine}: {done.stderr.strip()}")
    return json.loads(done.stdout)


def without(words, *options):
    """The command line without these options and their values."""
    kept, skip = [], False
    for word in words:
        skip = skip or word in options
        if not skip:
            kept.append(word)
        skip = word in options and "=" not in word
    return kept


def compared(command, report, folder):
    """What an estimate of a run comes to."""
    report = report or draw(command, "model", f"{folder}/model")
    estimate = draw(command, "estimate", f"{folder}/estimate")
    interval = estimate["estimated"]["cycles"]
    return {
        "traverser": report["traverser"],
        "frame": [report[part] for part in ("scene", "view", "size", "depth")],
        "cycles": report["cycles"],
        "estimate": interval["value"],
        "error": interval["value"] / report["cycles"] - 1,
        "holds": interval["low"] <= report["cycles"] <= interval["high"],
    }


def row(name, runs):
    errors = sorted(abs(run["error"]) for run in runs)
    pairs = [(a, b) for a, b in itertools.combinations(runs, 2)
             if a["frame"] == b["frame"] and abs(a["cycles"] / b["cycles"] - 1) > APART]  # fmt: skip
    right = sum((a["cycles"] < b["cycles"]) == (a["estimate"] < b["estimate"]) for a, b in pairs)
    share = f"{100 * right / len(pairs):.1f}% of {len(pairs)}" if pairs else "-"
    print(
        f"{name:9}  {len(runs):4}  {100 * errors[len(errors) // 2]:5.1f}%  "
        f"{100 * errors[min(len(errors) - 1, len(errors) * 95 // 100)]:5.1f}%  {100 * errors[-1]:6.1f}%  "
        f"{100 * sum(run['holds'] for run in runs) / len(runs):13.1f}%  {share:>18}"
    )


def main():
    parser = argparse.ArgumentParser(prog="estimates.py", description=__doc__.split("\n", 1)[0])
    parser.add_argument("reports", nargs="*", metavar="REPORT", type=pathlib.Path)
    parser.add_argument("--machines", type=int, default=200, metavar="N", help="random ones (default: 200)")
    parser.add_argument("--seed", type=int, default=1, metavar="S", help="of their choice (default: 1)")
    parser.add_argument("--file", action="append", default=[], metavar="NAME=PATH", help="another scene to draw")
    options = parser.parse_args()
    if options.machines < 1:
        parser.error("--machines must be 1 or more")
    tasks = []
    for path in options.reports:
        found = sorted(path.rglob("report.json")) if path.is_dir() else [path]
        if not found:
            parser.error(f"{path} has no report.json below it")
        for file in found:
            report = json.loads(file.read_text())
            if report["engine"] not in ("model", "rtl", "lockstep"):
                continue
            words = without(report["command"][1:], "--engine", "--out", "--boundary", "--cycles")
            tasks.append(([word for word in words if word not in ("--json", "--quiet")], report))
    if not options.reports:
        chance = random.Random(options.seed)
        files = dict(file.split("=", 1) for file in options.file)
        tasks = [(random_command(chance, files), None) for _ in range(options.machines)]
    if not tasks:
        parser.error("no report is of engine model, rtl or lockstep")
    with tempfile.TemporaryDirectory() as folder, concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        started = [pool.submit(compared, *task, f"{folder}/{number}") for number, task in enumerate(tasks)]
        runs = []
        for number, task in enumerate(started, 1):
            runs.append(task.result())
            if number % 20 == 0:
                print(f"  {number} of {len(started)}", file=sys.stderr)
    print("traverser  runs  median     95%  largest  intervals hold  faster of two found")
    for traverser in ("static", "hardware"):
        if of_it := [run for run in runs if run["traverser"] == traverser]:
            row(traverser, of_it)
    row("all", runs)


if __name__ == "__main__":
    main()
