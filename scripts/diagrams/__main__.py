"""Draws the pictures of the machine into docs/images, or checks them:

    PYTHONPATH=scripts python3 -m diagrams RAYPOOL FOLDER [--check]

FOLDER keeps what Icarus makes. A picture whose modules are not in rtl/ or sim/chip/ is refused. --check writes nothing
and ends with 1 if a picture would change.
"""
import pathlib
import shutil
import sys

from . import chip, compute_unit, stages
from .svg import DiagramError

ROOT = stages.ROOT
MODULES = {path.stem for path in (ROOT / "rtl").glob("*.v")} | {path.stem for path in (ROOT / "sim/chip").glob("*.hpp")}


def pictures(raypool, folder):
    for tool in ("iverilog", "vvp"):
        if shutil.which(tool) is None:
            raise DiagramError(f"{tool} was not found: install it (Debian package iverilog)")
    return {"compute-unit": compute_unit.draw(), "chip": chip.draw(), "stages": stages.draw(raypool, folder)}


def main(arguments):
    if len(arguments) not in (2, 3) or arguments[2:] not in ([], ["--check"]):
        print(__doc__, file=sys.stderr)
        return 2
    different = []
    for name, picture in pictures(arguments[0], pathlib.Path(arguments[1]).resolve()).items():
        unknown = sorted(picture.modules - MODULES)
        if unknown:
            raise DiagramError(f"docs/images/{name}.svg would show {', '.join(unknown)}: not in rtl/ or sim/chip/")
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
