"""Runs one point of a sweep: python3 -m sweep.point FOLDER KEY. Snakemake calls it, here or on a node of a cluster.

A point that is finished is left alone, one that is being run elsewhere is waited for, and one that fails leaves its
sentence; all else is repeated by the next call."""
import ctypes
import json
import os
import shutil
import signal
import socket
import subprocess
import sys

from .raypool import ROOT, digest_of_file, sentence
from .store import Store, write_json, write_whole

# Of prctl(2): a signal for the child when its parent is gone, so that nothing goes on in a folder without its lock.
PR_SET_PDEATHSIG = 1
LIBC = ctypes.CDLL(None)
# The sweep, or the node, was stopped: no failure of the point.
STOPPED = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


def end_with_parent():
    LIBC.prctl(PR_SET_PDEATHSIG, signal.SIGKILL)


def run(job, folder):
    """Runs raypool into `folder`; returns the sentence of a failure or None."""
    failure = changed(job)
    if failure is not None:
        return failure
    with open(os.path.join(folder, "log.txt"), "w", encoding="utf-8") as log:
        command = [job["program"], *job["arguments"], "--quiet", "--out", folder]
        done = subprocess.run(
            command, cwd=ROOT, stdout=log, stderr=subprocess.STDOUT, preexec_fn=end_with_parent, check=False
        )
    if -done.returncode in STOPPED:
        sys.exit(1)
    if done.returncode != 0:
        with open(os.path.join(folder, "log.txt"), encoding="utf-8", errors="replace") as log:
            return sentence(log.read(), done.returncode)
    return changed(job) or other_machine(job, folder)


def changed(job):
    """A result that is not of what the key stands for must not be kept under it."""
    for path, digest in job["digests"].items():
        if digest_of_file(path) != digest:
            return f"{path} was changed while the sweep was running: start it again"
    return None


def other_machine(job, folder):
    with open(os.path.join(folder, "report.json"), encoding="utf-8") as file:
        if json.load(file)["configuration"] != job["machine"]:
            return f"configuration {job['machine']['name']} was changed while the sweep was running: start it again"
    return None


def describe(job, folder):
    write_json(
        os.path.join(folder, "point.json"),
        {
            "key": job["key"],
            "point": job["point"],
            "picture": digest_of_file(os.path.join(folder, "image.png"))[:16],
            "host": socket.gethostname(),
            "depends_on": job["depends_on"],
        },
    )


def finish(store, key, folder, failure):
    """The folder becomes that of a finished point, or of a failed one."""
    shutil.rmtree(store.path("failed", key), ignore_errors=True)
    if failure is None:
        # Without point.json it is not a finished one.
        shutil.rmtree(store.path("points", key), ignore_errors=True)
        os.rename(folder, store.path("points", key))
        store.log("finish", key)
    else:
        write_whole(os.path.join(folder, "error.txt"), failure + "\n")
        os.rename(folder, store.path("failed", key))
        store.log("fail", key)


def main():
    store, key = Store(sys.argv[1]), sys.argv[2]
    with store.locked(key):
        if store.finished(key):
            return 0
        if store.failure(key) is not None:
            return 1
        with open(store.path(".work/plan", key), encoding="utf-8") as file:
            job = json.load(file)
        folder = store.path(".work/unfinished", key)
        shutil.rmtree(folder, ignore_errors=True)
        os.makedirs(folder)
        store.log("start", key)
        try:
            failure = run(job, folder)
        except OSError as error:
            failure = f"{error.filename or job['program']}: {error.strerror}"
        if failure is None:
            describe(job, folder)
        finish(store, key, folder, failure)
        return 0 if failure is None else 1


if __name__ == "__main__":
    sys.exit(main())
