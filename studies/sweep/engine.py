"""Has Snakemake run the points that are not finished, here or through Slurm."""
import os
import shutil
import signal
import subprocess
import sys
import time

from .errors import SweepError
from .point import end_with_parent
from .raypool import ROOT
from .store import write_json

HERE = os.path.dirname(os.path.abspath(__file__))
POLL_SECONDS = 0.3
# A node that goes down takes its jobs with it: each is tried again this often.
RETRIES = 3


def need(tool, group):
    if shutil.which(tool) is None:
        raise SweepError(f"{tool} was not found: scripts/setup.sh {group} installs it, make sweep does so by itself")


def prepare(store, plan, todo):
    """Marks, failures and unfinished folders of an earlier sweep go; a point that still runs keeps its own."""
    for name in (".work/done", ".work/plan"):
        shutil.rmtree(store.path(name))
        os.makedirs(store.path(name))
    for planned in plan.points:
        shutil.rmtree(store.path("failed", planned.key), ignore_errors=True)
    for key in os.listdir(store.path(".work/unfinished")):
        try:
            with store.locked(key, wait=False):
                shutil.rmtree(store.path(".work/unfinished", key), ignore_errors=True)
        except SweepError:
            pass
    for key, planned in todo.items():
        write_json(store.path(".work/plan", key), planned.job)
    write_json(store.path(".work/keys.json"), list(todo))


def snakemake(store, where, jobs):
    """Its command."""
    command = [
        "snakemake", "--snakefile", os.path.join(HERE, "Snakefile"), "--directory", store.path(".work"),
        "--scheduler", "greedy", "--nolock", "--ignore-incomplete", "--rerun-triggers", "mtime", "--keep-going",
        "--nocolor",
    ]  # fmt: skip
    if where == "slurm":
        output = store.path(".work/slurm")
        os.makedirs(output, exist_ok=True)
        # Snakemake alone tries again, so that a point is not in the queue twice.
        submit = f"sbatch --parsable --no-requeue --job-name=raypool --output='{output}/%j.txt'"
        command += [
            "--jobs", str(jobs), "--cluster", submit, "--cluster-status", os.path.join(HERE, "slurm_status.py"),
            "--cluster-cancel", "scancel", "--retries", str(RETRIES), "--latency-wait", "60",
            "--max-jobs-per-second", "20", "--max-status-checks-per-second", "20",
        ]  # fmt: skip
    else:
        command += ["--cores", str(jobs)]
    values = {"keys": store.path(".work/keys.json"), "python": sys.executable, "scripts": os.path.dirname(HERE),
              "folder": store.folder}
    return command + ["--config"] + [f"{name}={value}" for name, value in values.items()]


def text_of(title, done, todo, failed, seconds):
    text = f"  sweep {title}: {done} of {todo} points, "
    text += f"{failed} failed, " if failed else ""
    text += f"{seconds:.0f} s"
    return text + (f", about {seconds * (todo / done - 1):.0f} s to go" if done else "")


def watch(process, store, plan, todo, progress):
    begin = time.monotonic()
    waiting = set(todo)
    failed = set()
    while process.poll() is None:
        waiting = {key for key in waiting if not store.finished(key)}
        failed = {key for key in waiting if store.failure(key) is not None}
        done = len(todo) - len(waiting) + len(failed)
        progress.show(text_of(plan.experiment.title, done, len(todo), len(failed), time.monotonic() - begin))
        time.sleep(POLL_SECONDS)
    progress.clear()


def run(store, plan, where, jobs, progress):
    """Runs what is not finished; returns how many points that were."""
    todo = {planned.key: planned for planned in plan.points if not store.finished(planned.key)}
    prepare(store, plan, todo)
    if not todo:
        return 0
    need("snakemake", "sweep")
    if where == "slurm":
        need("sbatch", "slurm")
    with open(store.path("snakemake.log"), "w", encoding="utf-8") as log:
        process = subprocess.Popen(
            snakemake(store, where, jobs), cwd=ROOT, stdout=log, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL,
            preexec_fn=end_with_parent, start_new_session=True,
        )  # fmt: skip
        try:
            watch(process, store, plan, todo, progress)
        except KeyboardInterrupt:
            stop(process)
            raise
    return len(todo)


def stop(process):
    """Snakemake takes its jobs away, and here what they have started goes too."""
    os.killpg(process.pid, signal.SIGINT)
    try:
        process.wait(30)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()
