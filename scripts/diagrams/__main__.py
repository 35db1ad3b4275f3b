"""Draws the pictures of the machine into docs/images, or checks them:

    PYTHONPATH=scripts python3 -m diagrams RAYPOOL FOLDER [--check]

FOLDER keeps what Icarus makes. A picture with modules that are not in rtl/ is refused, and one of the chip that lacks a
block of it, or shows another. --check writes nothing and ends with 1 if a picture would change.
"""
import pathlib
import re
import shutil
import sys

from . import chip_verilog, compute_unit, stages
from .svg import DiagramError

ROOT = stages.ROOT
MODULES = {path.stem.removeprefix("rp_") for path in (ROOT / "rtl").glob("*/*.v")}
INSTANCE = re.compile(r"^ *(\w+) *(?:#\(|\w+ *\()", re.M)


def modules_within(module):
    """The modules of rtl/ of which this one has instances."""
    text = next((ROOT / "rtl").glob(f"*/rp_{module}.v")).read_text()
    return {name.removeprefix("rp_") for name in INSTANCE.findall(text)} & MODULES - {module}


def check_chip(picture):
    """It shows each block of the modules that it opens, and no other."""
    inside = set().union(*map(modules_within, chip_verilog.OPENED)) - chip_verilog.LEFT_OUT
    missing, wrong = sorted(inside - picture.modules), sorted(picture.modules - inside - {"chip"})
    if missing or wrong:
        raise DiagramError(f"docs/images/chip-verilog.svg lacks {missing or 'nothing'} of rtl/chip/rp_chip.v and shows "
                           f"{wrong or 'nothing'} that is not in it: mend scripts/diagrams/chip_verilog.py")
    return picture


def pictures(raypool, folder):
    for tool in ("iverilog", "vvp"):
        if shutil.which(tool) is None:
            raise DiagramError(f"{tool} was not found: install it (Debian package iverilog)")
    return {
        "compute-unit": compute_unit.draw(),
        "chip-verilog": check_chip(chip_verilog.draw()),
        "stages": stages.draw(raypool, folder),
    }


def main(arguments):
    if len(arguments) not in (2, 3) or arguments[2:] not in ([], ["--check"]):
        print(__doc__, file=sys.stderr)
        return 2
    different = []
    for name, picture in pictures(arguments[0], pathlib.Path(arguments[1]).resolve()).items():
        unknown = sorted(picture.modules - MODULES)
        if unknown:
            raise DiagramError(f"docs/images/{name}.svg would show {', '.join(unknown)}: not in rtl/")
        file, text = ROOT / f"docs/images/{name}.svg", picture.svg()
        if file.exists() and file.read_text() == text:
            continue
        different.append(str(file.relative_to(ROOT)))
        if not arguments[2:]:
            file.write_text(text)
    if arguments[2:] and different:
        names = ", ".join(different)
        print(f"diagrams: {names} would be drawn otherwise now; run make diagrams and look at it", file=sys.stderr)
        return 1
    print(f"diagrams: {'drawn: ' + ', '.join(different) if different else 'nothing to draw'}")
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1:]))
    except DiagramError as error:
        print(f"diagrams: {error}", file=sys.stderr)
        sys.exit(1)
