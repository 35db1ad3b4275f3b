#!/usr/bin/env python3
"""Sweeps through Slurm: studies/tests/sweep_slurm_test.py RAYPOOL

Starts a cluster of two nodes on this machine, with a controller, daemons and keys of its own in a folder of its own.
Reports it and does nothing where that is not possible."""
import contextlib
import os
import pathlib
import secrets
import shutil
import signal
import socket
import subprocess
import sys
import time
import unittest

import sweep_test

CONF = """
ClusterName=raypool
SlurmctldHost={host}(127.0.0.1)
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
CredType=cred/munge
SlurmUser=root
SlurmdUser=root
SlurmctldPort={ports[0]}
SlurmctldPidFile={folder}/controller.pid
SlurmdPidFile={folder}/%n.pid
SlurmctldLogFile={folder}/controller.log
SlurmdLogFile={folder}/%n.log
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool.%n
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SlurmdParameters=config_overrides
SlurmdTimeout=6
NodeName=n0 NodeHostname={host} NodeAddr=127.0.0.1 Port={ports[1]} CPUs=2
NodeName=n1 NodeHostname={host} NodeAddr=127.0.0.1 Port={ports[2]} CPUs=2
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
"""


class NoCluster(Exception):
    pass


def call(*command):
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    if done.returncode != 0:
        raise NoCluster(f"{command[0]}: {(done.stderr or done.stdout).strip()}")
    return done.stdout


def free_ports(number):
    with contextlib.ExitStack() as stack:
        sockets = [stack.enter_context(socket.socket()) for _ in range(number)]
        for each in sockets:
            each.bind(("127.0.0.1", 0))
        return [each.getsockname()[1] for each in sockets]


def command_line(pid):
    try:
        return pathlib.Path(f"/proc/{pid}/cmdline").read_bytes().replace(b"\0", b" ").decode(errors="replace")
    except OSError:
        return ""


class Cluster:
    def __init__(self, folder):
        self.folder = folder
        missing = [tool for tool in ("munged", "slurmctld", "slurmd", "sbatch") if shutil.which(tool) is None]
        if missing or os.geteuid() != 0:
            raise NoCluster(f"{', '.join(missing)} not installed" if missing else "that needs root")
        folder.chmod(0o755)
        (folder / "state").mkdir()
        (folder / "munge.key").write_bytes(secrets.token_bytes(128))
        (folder / "munge.key").chmod(0o400)
        host = socket.gethostname().split(".")[0]
        self.conf = folder / "slurm.conf"
        self.conf.write_text(CONF.format(folder=folder, host=host, ports=free_ports(3)))
        os.environ["SLURM_CONF"] = str(self.conf)

    def start(self):
        munge = {"key-file": "key", "socket": "socket", "pid-file": "pid", "log-file": "log", "seed-file": "seed"}
        call("munged", "--force", *(f"--{option}={self.folder}/munge.{end}" for option, end in munge.items()))
        call("slurmctld", "-c", "-f", str(self.conf))
        for node in ("n0", "n1"):
            call("slurmd", "-f", str(self.conf), "-N", node)
        end = time.monotonic() + 60
        while call("sinfo", "--noheader", "--format=%D %t").split() != ["2", "idle"]:
            if time.monotonic() > end:
                raise NoCluster("its nodes do not become idle")
            time.sleep(0.5)

    def pid(self, name):
        try:
            return int((self.folder / f"{name}.pid").read_text())
        except (OSError, ValueError):
            return None

    def stop(self):
        """What it has started, by the numbers that it has written down."""
        for name in ("n0", "n1", "controller", "munge"):
            if (pid := self.pid(name)) is not None:
                with contextlib.suppress(ProcessLookupError):
                    os.kill(pid, signal.SIGTERM)
        end = time.monotonic() + 20
        while any(self.pid(name) for name in ("n0", "n1", "controller")) and time.monotonic() < end:
            time.sleep(0.2)

    def take_down(self, node, job):
        """The node's daemon, and all of a job that runs on it, are gone at once."""
        steps = [int(path.name) for path in pathlib.Path("/proc").glob("[0-9]*")
                 if command_line(path.name).startswith(f"slurmstepd: [{job}.")]  # fmt: skip
        steps = [pid for pid in steps if str(self.conf) in pathlib.Path(f"/proc/{pid}/environ").read_text()] or steps
        sweep_test.kill([self.pid(node), *steps, *(pid for step in steps for pid in sweep_test.children(step))])
        (self.folder / f"{node}.pid").unlink(missing_ok=True)


class Slurm(sweep_test.SweepTest):
    def setUp(self):
        super().setUp()
        self.cluster = None
        (self.folder / "cluster").mkdir()
        try:
            self.cluster = Cluster(self.folder / "cluster")
            self.addCleanup(self.cluster.stop)
            self.cluster.start()
        except (NoCluster, subprocess.TimeoutExpired) as error:
            print(f"no cluster can be started here: {error}")
            self.skipTest(str(error))

    def test_a_node_that_goes_down_costs_only_its_points(self):
        document = {"base": sweep_test.TINY, "product": {"depth": [7, 1, 2, 3, 13]}}
        (self.folder / "works").touch()
        here = self.folder / "here"
        self.run_sweep(document, out=here)
        (self.folder / "works").unlink()
        (self.folder / "hang").touch()
        sweep = self.start("--where=slurm", "--jobs=4")
        self.until((self.folder / "hangs").exists, "no point hangs")
        node, job = (self.folder / "hangs").read_text().split()
        before = self.finished()
        self.cluster.take_down(node, job)
        self.assertEqual(sweep.wait(300), 3)  # the point of depth 13 fails
        self.assertEqual(len(self.finished()), 4)
        starts = self.starts()
        self.assertFalse({key for key in starts if starts.count(key) > 1} & before)
        # A sentence of raypool is not asked for again on other nodes.
        log = (self.out / "starts.log").read_text()
        self.assertEqual(log.count("fail "), 1)
        (self.folder / "works").touch()
        self.run_sweep(document, "--where=slurm")
        for name in ("table.json", "table.csv"):
            self.assertEqual((self.out / name).read_bytes(), (here / name).read_bytes())


if __name__ == "__main__":
    sweep_test.RAYPOOL = str(pathlib.Path(sys.argv[1]).resolve())
    unittest.main(argv=[sys.argv[0], *sys.argv[2:]])
