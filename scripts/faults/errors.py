"""What is wrong, in one sentence; and the running of tools."""
import shutil
import subprocess


class Refused(Exception):
    """One sentence for the user."""


def yosys(script, log):
    """Runs it; what it prints goes into the file."""
    if shutil.which("yosys") is None:
        raise Refused("yosys was not found: install it (Debian package yosys)")
    with open(log, "w", encoding="utf-8") as out:
        done = subprocess.run(["yosys", "-p", script], stdout=out, stderr=subprocess.STDOUT, check=False)
    if done.returncode != 0:
        raise Refused(f"Yosys fails:\n{log.read_text()[-3000:]}")
