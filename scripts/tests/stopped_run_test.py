#!/usr/bin/env python3
"""A run that is stopped, fails or is killed leaves its waveform where it can be seen: scripts/tests/stopped_run_test.py
RAYPOOL. Needs the Verilated chip that follow_test.py makes, and fst2vcd."""
import pathlib
import signal
import struct
import subprocess
import sys
import tempfile
import time
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(ROOT / "scripts"))
from follow.__main__ import TRAVERSER  # noqa: E402

RAYPOOL = ""
CHIP = ("--config", "4w4c", "--set", TRAVERSER, "--engine", "rtl", "--boundary", "chip", "--waves")
LONG = ("sim", "cornell", "--size", "512x512", "--depth", "3")


class StoppedRun(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name) / "out"

    def start(self, *arguments):
        command = [RAYPOOL, *LONG, *CHIP, "--out", str(self.folder), *arguments]
        process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.addCleanup(process.kill)
        return process

    def wait_for_waveform(self, process):
        """Until it has been begun, by a run that goes on."""
        for _ in range(600):
            if any(path.stat().st_size for path in self.folder.glob(".*.waves.fst")):
                self.assertIsNone(process.poll(), "the run has ended by itself")
                return
            time.sleep(0.1)
        self.fail("no waveform is begun")

    def names(self):
        return sorted(path.name for path in self.folder.iterdir())

    def check_readable(self, name):
        """To the end that its header has, which is written when it is finished."""
        kind, _, _, end = struct.unpack(">BQQQ", (self.folder / name).read_bytes()[:25])
        self.assertEqual(kind, 0)
        self.assertGreater(end, 0)
        with subprocess.Popen(["fst2vcd", str(self.folder / name)], stdout=subprocess.PIPE) as reader:
            last = [line for line in reader.stdout if line.startswith(b"#")][-1]
        self.assertEqual(reader.returncode, 0)
        self.assertEqual(int(last[1:]), end)

    def test_a_signal_leaves_the_waveform_under_its_name(self):
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            with self.subTest(number=number):
                process = self.start()
                self.wait_for_waveform(process)
                process.send_signal(number)
                _, said = process.communicate(timeout=60)
                self.assertEqual(process.returncode, -number)
                self.assertEqual(self.names(), ["waves.fst"])
                self.assertIn(f"raypool: the waveform until then is {self.folder}/waves.fst\n", said)
                self.assertIn(f"raypool: stopped by {number.name}", said)
                self.check_readable("waves.fst")

    def test_a_killed_runs_waveform_is_named_and_told_by_the_next_run(self):
        process = self.start()
        self.wait_for_waveform(process)
        process.kill()
        process.communicate(timeout=60)
        # Whatever the next one is asked for.
        done = subprocess.run([RAYPOOL, "sim", "cornell", "--size", "8x8", "--engine", "native", "--quiet", "--out",
                               str(self.folder)], capture_output=True, text=True, check=True)  # fmt: skip
        kept = f"killed-{process.pid}-waves.fst"
        self.assertEqual(self.names(), ["image.png", kept, kept + ".hier", "report.json"])
        said = f"raypool: a run that was killed left its waveform: it is {self.folder}/{kept} now\n"
        self.assertEqual(done.stderr, said)

    def test_two_runs_in_one_folder_do_not_take_each_others_waveform(self):
        process = self.start()
        self.wait_for_waveform(process)
        subprocess.run([RAYPOOL, "sim", "cornell", "--size", "8x8", "--engine", "native", "--quiet", "--out",
                        str(self.folder)], check=True)  # fmt: skip
        process.send_signal(signal.SIGTERM)
        process.communicate(timeout=60)
        self.assertEqual(self.names(), ["image.png", "report.json", "waves.fst"])

    def test_a_run_that_is_stopped_without_a_waveform_leaves_nothing(self):
        process = subprocess.Popen([RAYPOOL, "sim", "cornell", "--size", "4096x4096", "--engine", "model", "--quiet",
                                    "--out", str(self.folder)], stderr=subprocess.PIPE, text=True)  # fmt: skip
        time.sleep(1)
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=60)
        self.assertEqual(process.returncode, -signal.SIGINT)
        self.assertEqual(self.names() if self.folder.exists() else [], [])


if __name__ == "__main__":
    RAYPOOL = str(pathlib.Path(sys.argv[1]).resolve())
    unittest.main(argv=[sys.argv[0], *sys.argv[2:]])
