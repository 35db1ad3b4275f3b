#!/usr/bin/env python3
"""Checks the coverage of the confidence intervals of engine `sampled`: how many contain what the whole frame takes.

    studies/intervals.py [--samples N] [--error PERCENT] [--scenes NAME,...] [--configs NAME,...] [--size WxH]
      [--traverser static|hardware] [--out FILE]

Draws each scene on each machine once with engine model, and so many times with engine sampled, each time with another
seed. Prints, of each figure, which share of the 95% intervals contains its true value. Over all frames it must be 92 to
98% for the cycles, and no less than 90% for every other figure; else the exit code is 3. `make intervals` calls it.
RAYPOOL names the program, default raypool in the build folder (BUILD).
"""
import argparse
import collections
import concurrent.futures
import json
import math
import os
import pathlib
import subprocess
import sys
import tempfile

BUILD = os.environ.get("BUILD", "build")
RAYPOOL = os.path.abspath(os.environ.get("RAYPOOL", os.path.join(BUILD, "raypool")))
FEWEST, MOST = 0.92, 0.98  # of the intervals of the cycles
FEWEST_OF_OTHERS = 0.90
# Figures that are small and come in bursts are known badly, and have no interval to check.
LEAST_SHARE = 0.01  # a utilisation below is not asked for
FAILURE, OUTSIDE = 1, 3
# {traverser: pictures of which samples of a few percent are parts}
SIZES = {"static": "256x256", "hardware": "512x512"}


def edge_scene(folder):
    """Half of the picture is a wall that reflects nothing, the other half bars that are mirrors to each other."""
    lines = ["mtllib edge.mtl", "usemtl wall", "v -4 -2 -1", "v 0 -2 -1", "v 0 2 -1", "v -4 2 -1", "f 1 2 3 4",
             "usemtl mirror"]  # fmt: skip
    count = 4
    for bar in range(120):
        for row in range(40):
            x, y = bar / 30, row / 10 - 2
            depth = 0.35 * (1 + math.sin(7 * bar + 3 * row)) / 2
            corners = ((x, y, -1), (x + 1 / 30, y, -1 + depth), (x + 1 / 30, y + 0.1, -1 - depth), (x, y + 0.1, -1))
            lines += ["v {:.5f} {:.5f} {:.5f}".format(*corner) for corner in corners]
            lines.append("f " + " ".join(str(count + i) for i in range(1, 5)))
            count += 4
    (folder / "edge.obj").write_text("\n".join(lines) + "\n")
    (folder / "edge.mtl").write_text("newmtl wall\nKd 0.7 0.7 0.7\n"
                                     "newmtl mirror\nKd 0.3 0.3 0.3\nKs 0.6 0.6 0.6\nillum 3\n")
    return [str(folder / "edge.obj"), "--eye", "0,0,4", "--look-at", "0,0,0", "--fov", "50", "--light", "0,3,4"]


SCENES = {
    "cornell": lambda folder: ["cornell"],
    "room": lambda folder: ["room", "--detail", "0.1"],
    "edge": edge_scene,
}


class IntervalsError(Exception):
    """A sentence for the user."""


def draw(frame, *options):
    with tempfile.TemporaryDirectory() as folder:
        command = [RAYPOOL, "sim", *frame, *options, "--quiet", "--json", "--out", folder]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise IntervalsError(done.stderr.strip() or f"{' '.join(command)} ended with {done.returncode}")
    return json.loads(done.stdout)


def truth(report):
    """{figure: value} of engine model."""
    values = {"cycles": report["cycles"], "Mrays/s": report["mrays_per_second"]}
    shares = {name: alu["utilisation"] for name, alu in report["alus"].items()}
    shares["ray_port"] = report["pools"]["ray_port_utilisation"]
    shares["intersection_port"] = report["pools"]["intersection_port_utilisation"]
    shares["memory_port"] = report["memory"]["port_utilisation"]
    return values | {name: share for name, share in shares.items() if share >= LEAST_SHARE}


def intervals(report):
    sampled = report["sampled"]
    return {"cycles": sampled["cycles"], "Mrays/s": sampled["mrays_per_second"], **sampled["alus"], **sampled["ports"]}


def check(frame, arguments, say):
    """({figure: intervals that contain it}, errors of the cycles, half widths, share of tiles simulated)"""
    true = truth(draw(frame, "--engine", "model"))
    contained, errors, widths, tiles = collections.Counter(), [], [], []

    def sample(seed):
        return draw(frame, "--engine", "sampled", "--error", arguments.error, "--seed", str(seed))

    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for number, report in enumerate(pool.map(sample, range(1, arguments.samples + 1)), 1):
            if report["sampled"]["whole"]:
                raise IntervalsError(f"{frame[0]}: with --error {arguments.error} the whole frame is simulated: "
                                     "give a larger error or a larger --size")
            found = intervals(report)
            contained.update({name: found[name]["low"] <= value <= found[name]["high"]
                              for name, value in true.items()})  # fmt: skip
            errors.append(report["cycles"] / true["cycles"] - 1)
            widths.append(report["sampled"]["error"])
            tiles.append(report["sampled"]["simulated_tiles"] / report["sampled"]["tiles"])
            say(f"{number} of {arguments.samples} samples")
    return {name: contained[name] for name in true}, errors, widths, tiles


def mean(values):
    return sum(values) / len(values)


def parse(words):
    parser = argparse.ArgumentParser(description="How many intervals of engine sampled contain the true value.")
    parser.add_argument("--samples", type=int, default=200, help="seeds of each frame (%(default)s)")
    parser.add_argument("--error", default="10%", help="that is asked for (%(default)s)")
    parser.add_argument("--scenes", default=",".join(SCENES), help="of %(default)s")
    parser.add_argument("--configs", default="4w4c,8w8c", help="machines (%(default)s)")
    parser.add_argument("--traverser", choices=SIZES, default="static", help="of the machines (%(default)s)")
    sizes = ", ".join(f"{traverser}: {size}" for traverser, size in SIZES.items())
    parser.add_argument("--size", help=f"of the picture ({sizes})")
    parser.add_argument("--depth", default="3", help="of reflections (%(default)s)")
    parser.add_argument("--out", type=pathlib.Path, help="the figures as JSON")
    arguments = parser.parse_args(words)
    unknown = [name for name in arguments.scenes.split(",") if name not in SCENES]
    if unknown:
        raise IntervalsError(f"there is no scene '{unknown[0]}': use {', '.join(SCENES)}")
    if arguments.samples < 1:
        raise IntervalsError("--samples must be 1 or more")
    return arguments


def progress(text):
    if sys.stderr.isatty():
        print(f"\r  {text}   ", end="", file=sys.stderr, flush=True)


def run(arguments, folder):
    frames, sums, asked = [], collections.Counter(), collections.Counter()
    print(f"{'scene':<9} {'machine':<10} {'contain the cycles':>18} {'mean error':>11} {'spread':>7} "
          f"{'half width':>11} {'tiles simulated':>16}")
    for scene in arguments.scenes.split(","):
        for config in arguments.configs.split(","):
            frame = [*SCENES[scene](folder), "--config", config, "--traverser", arguments.traverser, "--size",
                     arguments.size or SIZES[arguments.traverser], "--depth", arguments.depth]  # fmt: skip
            contained, errors, widths, tiles = check(frame, arguments, lambda text: progress(f"{scene}, {text}"))
            sums.update(contained)
            asked.update({name: arguments.samples for name in contained})
            spread = math.sqrt(mean([(error - mean(errors)) ** 2 for error in errors]))
            frames.append({"scene": scene, "config": config, "samples": arguments.samples, "contained": contained,
                           "mean_error": mean(errors), "spread": spread, "half_width": mean(widths),
                           "tiles_simulated": mean(tiles)})  # fmt: skip
            progress("")
            print(f"{scene:<9} {config:<10} {contained['cycles'] / arguments.samples:>18.1%} {mean(errors):>+11.2%} "
                  f"{spread:>7.2%} {mean(widths):>11.2%} {mean(tiles):>16.1%}", flush=True)
    shares = {name: sums[name] / asked[name] for name in asked}
    print("\nof all, contain the true value: " + ", ".join(f"{name} {share:.1%}" for name, share in shares.items()))
    bad = [name for name, share in shares.items()
           if not (FEWEST <= share <= MOST if name == "cycles" else share >= FEWEST_OF_OTHERS)]  # fmt: skip
    if arguments.out:
        document = {"command": sys.argv, "frames": frames, "contained": shares}
        arguments.out.write_text(json.dumps(document, indent=2) + "\n")
    print(f"coverage outside its limits: {', '.join(bad)}" if bad else f"coverage within its limits: of the cycles "
          f"{FEWEST:.0%} to {MOST:.0%}, of each other figure {FEWEST_OF_OTHERS:.0%} or more")  # fmt: skip
    return OUTSIDE if bad else 0


def main():
    try:
        with tempfile.TemporaryDirectory() as folder:
            return run(parse(sys.argv[1:]), pathlib.Path(folder))
    except IntervalsError as error:
        print(f"intervals.py: {error}", file=sys.stderr)
        return FAILURE


if __name__ == "__main__":
    sys.exit(main())
