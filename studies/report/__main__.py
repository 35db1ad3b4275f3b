"""python3 -m report [--from FOLDER...] [--out FOLDER], with studies/ as the folder of modules. `make report` calls
it."""
import argparse
import os
import sys

from sweep.errors import SweepError
from sweep.raypool import PROGRAM, ROOT
from sweep.store import write_whole

from .errors import ReportError
from .figure import several
from .point import near
from .sources import Sources

BUILD = os.path.join(ROOT, os.environ.get("BUILD", "build"))
# Where the other targets leave what they make.
USUAL = ("sweeps", "out", "synth")


def parser():
    options = argparse.ArgumentParser(
        prog="report",
        description="Turns sweeps, runs and synthesis reports into one page, index.html (docs/use/page.md).",
    )
    options.add_argument("--from", dest="folders", nargs="+", default=[], metavar="FOLDER",
                         help="a sweep, run, synthesis report, or a folder of them (default: build/sweeps, out, synth)")
    options.add_argument("--out", default=os.path.join(BUILD, "report"), help="of index.html (default: build/report)")
    return options


def folders_of(arguments):
    for folder in arguments.folders:
        if not os.path.isdir(folder):
            what = "is not a folder" if os.path.exists(folder) else "does not exist"
            raise ReportError(f"FROM={folder} {what}: give folders of sweeps, runs (make sim) or synthesis reports")
    usual = [os.path.join(BUILD, name) for name in USUAL]
    folders = arguments.folders or [folder for folder in usual if os.path.isdir(folder)]
    if not folders:
        raise ReportError(f"there is nothing to show in {near(BUILD)} yet: make sim ENGINE=model or make sweep "
                          "EXPERIMENT=configs/experiments/caches.json makes something")
    return folders


def report(arguments):
    folders = folders_of(arguments)
    if not os.access(PROGRAM, os.X_OK):
        raise ReportError(f"{PROGRAM} was not found: make report builds it, or RAYPOOL names one")
    sources = Sources(folders)
    # Late, as Matplotlib takes a second to load.
    try:
        from . import areas, page
    except ModuleNotFoundError as error:
        raise ReportError(f"Python's module {error.name} was not found: scripts/setup.sh report installs it, "
                          "make report does so by itself") from error

    areas.find_areas([point for point in sources.points if point.timed], sources.synthesis)
    text, figures, notes = page.render(sources, folders)
    path = os.path.join(arguments.out, "index.html")
    try:
        os.makedirs(arguments.out, exist_ok=True)
        write_whole(path, text)
    except OSError as error:
        raise ReportError(f"{path}: cannot be written: {error.strerror}") from error
    for note in notes:
        print(f"left out {note}", file=sys.stderr)
    print(f"page     {near(path)}: {several(len(sources.points), 'point')}, {several(figures, 'figure')}, "
          f"{several(len(sources.synthesis), 'synthesis report')}")
    return 0


def main():
    try:
        return report(parser().parse_args())
    except (ReportError, SweepError) as error:
        print(f"report: {error}", file=sys.stderr)
        return 1


if __name__ == "__main__":
    sys.exit(main())
