"""python3 -m sweep EXPERIMENT, with studies/ as the folder of modules. `make sweep` calls it."""
import argparse
import os
import re
import sys

from . import engine, raypool, table
from .errors import SweepError
from .experiment import Experiment
from .plan import Plan
from .progress import Progress
from .store import Store

EXIT_CODES = """exit codes:
  0    every point is finished
  1    the experiment cannot be run as it is: nothing has run
  3    some points failed; the others are in the table
  130  interrupted; the same command goes on
"""
SLURM_JOBS = 100


def parser():
    options = argparse.ArgumentParser(
        prog="sweep",
        description="Runs every point of an experiment (docs/use/sweeps.md) that is not finished yet, and "
        "writes table.csv and table.json of all that are.",
        epilog=EXIT_CODES, formatter_class=argparse.RawDescriptionHelpFormatter)  # fmt: skip
    options.add_argument("experiment", help="JSON file, as in schemas/experiment.json")
    options.add_argument("--out", help="folder of points and tables (default: build/sweeps/ and the experiment's name)")
    options.add_argument("--where", choices=("here", "slurm"), default="here", help="where points run (default: here)")
    options.add_argument("--jobs", help=f"points at a time (default: a core each; slurm: {SLURM_JOBS})")
    options.add_argument("--check", action="store_true", help="check all of it, list the points, and run nothing")
    return options


def jobs_of(arguments):
    if arguments.jobs is None:
        return SLURM_JOBS if arguments.where == "slurm" else len(os.sched_getaffinity(0))
    if not re.fullmatch(r"0*[1-9]\d{0,3}|0*10000", arguments.jobs):
        raise SweepError(f"JOBS={arguments.jobs}: points at a time, from 1 to 10000")
    return int(arguments.jobs)


def report_failures(store, plan):
    failed = [planned for planned in plan.points if not store.finished(planned.key)]
    for planned in failed:
        reason = store.failure(planned.key)
        place = store.path("failed", planned.key) if reason else store.path("snakemake.log")
        print(
            f"sweep: point {planned.number} ({plan.experiment.shown(planned.point)}) failed: "
            f"{reason or 'it was not run to its end'} ({near(place)})",
            file=sys.stderr,
        )
    return len(failed)


def near(path):
    """As seen from here, if it is below."""
    seen = os.path.relpath(path)
    return path if seen.startswith("..") else seen


def list_points(store, plan):
    for planned in plan.points:
        state = "finished" if store.finished(planned.key) else "to do"
        print(f"{planned.key} {state:8} {plan.experiment.shown(planned.point)}")
    for planned in plan.left_out:
        print(f"{'':20} {'left out':8} {plan.experiment.shown(planned.point)}")


def sweep(arguments):
    progress = Progress()
    jobs = jobs_of(arguments)
    if not os.access(raypool.PROGRAM, os.X_OK):
        raise SweepError(f"{raypool.PROGRAM} was not found: make sweep builds it, or RAYPOOL names one")
    experiment = Experiment(arguments.experiment, raypool.settable_fields())
    plan = Plan(experiment, len(os.sched_getaffinity(0)), progress)
    progress.clear()
    name = os.path.splitext(os.path.basename(arguments.experiment))[0]
    store = Store(arguments.out or os.path.join(raypool.BUILD, "sweeps", name))
    if arguments.check:
        list_points(store, plan)
        return 0
    with store.locked("sweep", wait=False):
        ran = engine.run(store, plan, arguments.where, jobs, progress)
        table.write(store, plan)
        failed = report_failures(store, plan)
    keys = {planned.key for planned in plan.points}
    left_out = f", {len(plan.left_out)} left out by the filter" if plan.left_out else ""
    print(f"sweep    {experiment.title}: {len(plan.points)} points, {ran - failed if ran else 0} run now, "
          f"{len(keys) - ran} kept, {failed} failed{left_out}")
    print(f"tables   {near(store.path('table.csv'))}, table.json, times.csv")
    return 3 if failed else 0


def main():
    try:
        return sweep(parser().parse_args())
    except SweepError as error:
        print(f"sweep: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("\nsweep: interrupted; what is finished is kept, and the same command goes on", file=sys.stderr)
        return 130


if __name__ == "__main__":
    sys.exit(main())
