"""The area and power of a point's units, by the project's own synthesis, which keeps what it has once made."""
import json
import os
import subprocess
import sys
import tempfile

from . import raypool
from .errors import SweepError
from .experiment import text


class Areas:
    """Synthesises each distinct unit, or with `chip` each chip, once."""

    def __init__(self, progress, chip, power):
        self.progress = progress
        self.chip = chip
        self.power = power
        self.known = {}

    def of(self, planned):
        """{"area_mm2", "kge"} of all units of the point, or of its whole chip, at 40 nm; with power "power_mw", at the
        clock of the library.
        """
        if self.chip:
            return self.synthesised(planned, planned.settings, ["--chip", f"--units={text(planned.point['units'])}"])
        settings = {field: value for field, value in planned.settings.items() if not field.startswith("chip.")}
        units = int(planned.point["units"])
        return {name: round(units * value, 6) for name, value in self.synthesised(planned, settings, []).items()}

    def synthesised(self, planned, settings, chip):
        config = planned.point["config"]
        identity = raypool.ask_config(config, settings, "--verilog-parameters", *chip)
        if identity not in self.known:
            what, time = ("chip", "half an hour") if chip else ("unit", "minutes")
            self.progress.show(
                f"  synthesis {len(self.known) + 1}, {what} {planned.machine['name']}: a new one takes {time}", now=True
            )
            # Rounds for speed change a chip's area by a hundredth, and each times millions of cells.
            words = [*raypool.machine_words(config, settings), *chip, *(["--rounds=0"] if chip else [])]
            self.known[identity] = synthesise(words, self.power)
        return self.known[identity]


def synthesise(words, power):
    environment = {**os.environ, "PYTHONPATH": os.path.join(raypool.ROOT, "scripts"), "RAYPOOL": raypool.PROGRAM}
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "synth", "report", *words, "--out", folder, *(["--power"] if power else [])]
        done = subprocess.run(command, cwd=raypool.ROOT, env=environment, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise SweepError("the synthesis failed: " + raypool.sentence(done.stderr, done.returncode))
        with open(os.path.join(folder, "report.json"), encoding="utf-8") as file:
            report = json.load(file)
    measured = {"area_mm2": report["forty_nm"]["total_mm2"], "kge": report["area"]["total_kge"]}
    if power:
        measured["power_mw"] = 1000 * report["power"]["total_w"]
    return measured
