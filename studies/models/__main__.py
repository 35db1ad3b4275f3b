"""python3 -m models, with studies/ as the folder of modules: ten glTF models, drawn by raypool and by Blender's Cycles.

`make models` calls it. Leaves each model, both pictures and sheets that have them side by side, the third picture their
difference. RAYPOOL names the program, default raypool in the build folder (BUILD).
"""
import argparse
import os
import pathlib
import shutil
import subprocess
import sys

from . import ROOT
from .sheet import compare, contact_sheet, side_by_side
from .ten import MODELS

BUILD = os.environ.get("BUILD", "build")
RAYPOOL = os.path.abspath(os.environ.get("RAYPOOL", os.path.join(BUILD, "raypool")))
# A sample of Cycles takes a tenth of the time.
CYCLES_SAMPLES = 4


class Failure(Exception):
    pass


def parser():
    options = argparse.ArgumentParser(
        prog="models", description="Draws ten glTF models with raypool (engine native, shaders path) and with "
        "Blender's Cycles, and compares the pictures.")  # fmt: skip
    options.add_argument("--only", nargs="+", choices=list(MODELS), metavar="MODEL", default=list(MODELS),
                         help=f"of {', '.join(MODELS)}")
    options.add_argument("--size", default="192x144", help="WxH; the cameras are 4:3 (default: 192x144)")
    options.add_argument("--samples", type=int, default=64,
                         help=f"a pixel, of raypool; {CYCLES_SAMPLES} times as many of Cycles (default: 64)")
    options.add_argument("--depth", type=int, default=8, help="surfaces that a path meets (default: 8)")
    options.add_argument("--threads", help="of raypool and of Cycles (default: a core each)")
    options.add_argument("--out", default=os.path.join(BUILD, "out/models"), help="folder (default: %(default)s)")
    options.add_argument("--write-only", action="store_true", help="write the models, draw nothing")
    return options


def run(words, log):
    with open(log, "w", encoding="utf-8") as file:
        done = subprocess.run(words, cwd=ROOT, stdout=file, stderr=subprocess.STDOUT, check=False)
    text = log.read_text(errors="replace")
    if done.returncode:
        end = "\n".join(text.splitlines()[-5:])
        raise Failure(f"{words[0]} ended with {done.returncode}; {log} ends with:\n{end}")
    return text


def draw_with_raypool(model, folder, arguments):
    words = [RAYPOOL, "sim", str(model), "--engine", "native", "--shaders", "path", "--size", arguments.size,
             "--samples", str(arguments.samples), "--depth", str(arguments.depth), "--out", str(folder / "raypool")]
    text = run(words + (["--threads", arguments.threads] if arguments.threads else []), folder / "raypool.log")
    for line in text.splitlines():
        if "warning" in line:
            print(line, file=sys.stderr)
    return folder / "raypool/image.png"


def draw_with_cycles(model, folder, arguments, matt):
    blender = shutil.which("blender")
    if blender is None:
        raise Failure("there is no blender: scripts/setup.sh models installs it")
    picture = folder / f"{matt}.png"
    picture.unlink(missing_ok=True)
    run([blender, "--background", "--factory-startup", "-noaudio", "--threads", arguments.threads or "0",
         "--python-exit-code", "1", "--python", str(ROOT / "studies/models/cycles.py"), "--", str(model), str(picture),
         arguments.size, str(CYCLES_SAMPLES * arguments.samples), str(arguments.depth), matt], folder / f"{matt}.log")
    if not picture.exists():
        raise Failure(f"Blender has drawn nothing: {folder / f'{matt}.log'} says why")
    return picture


def print_row(name, ours, theirs, with_lambert):
    light, other, pixels, blocks = compare(ours, theirs)
    _, last, last_pixels, last_blocks = compare(ours, with_lambert)
    print(f"{name:<12} {light:7.4f} {other:7.4f} {light / other - 1:+6.1%} {pixels:6.1f} {blocks:6.1f} "
          f"{last:7.4f} {light / last - 1:+6.1%} {last_pixels:6.1f} {last_blocks:6.1f}", flush=True)


def main():
    arguments = parser().parse_args()
    out = pathlib.Path(arguments.out).resolve()
    pairs = {}
    for name in arguments.only:
        model = MODELS[name]().write(out / name)
        if arguments.write_only:
            print(model)
            continue
        ours = draw_with_raypool(model, out / name, arguments)
        theirs, with_lambert = (draw_with_cycles(model, out / name, arguments, matt) for matt in ("burley", "lambert"))
        pairs[name] = ours, theirs
        side_by_side(ours, theirs).save(out / f"{name}.png")
        side_by_side(ours, with_lambert).save(out / f"{name}-lambert.png")
        if len(pairs) == 1:
            print(f"{'model':<12} {'raypool':>7} {'Cycles':>7} {'light':>6} {'pixels':>6} {'blocks':>6} {'Lambert':>7} "
                  f"{'light':>6} {'pixels':>6} {'blocks':>6}")
        print_row(name, ours, theirs, with_lambert)
    if pairs:
        contact_sheet(pairs).save(out / "models.jpg", quality=86, optimize=True)
        print(f"pictures: {os.path.relpath(out)}: models.jpg, and two a model with the difference, 4 times as strong")


if __name__ == "__main__":
    try:
        main()
    except Failure as failure:
        sys.exit(f"models: {failure}")
