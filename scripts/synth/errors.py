"""What is wrong in a user's input, in one sentence; and the running of tools."""
import os
import shutil
import subprocess
import sys


class SynthError(Exception):
    """Bad input, a missing tool, or a tool's refusal; its text is the message for the user."""


def need(tool, package):
    """The path of a tool, or the sentence that names its Debian package."""
    path = shutil.which(tool)
    if path is None:
        raise SynthError(f"{tool} was not found: install the Debian package {package} (scripts/setup.sh synth)")
    return path


def run(command, log, cwd=None, stdin=None, environment=None):
    """Runs a tool with its output in file `log`; a failure shows the end of that file."""
    with open(log, "w", encoding="utf-8") as out:
        source = open(stdin, encoding="utf-8") if stdin else subprocess.DEVNULL
        done = subprocess.run(
            command,
            stdout=out,
            stderr=subprocess.STDOUT,
            stdin=source,
            cwd=cwd,
            env={**os.environ, **(environment or {})},
            check=False,
        )
    if done.returncode != 0:
        raise SynthError(f"{os.path.basename(command[0])} failed ({done.returncode}); the end of {log}:\n{tail(log)}")


def tail(path, lines=15):
    with open(path, encoding="utf-8", errors="replace") as text:
        return "".join(text.readlines()[-lines:]).rstrip()


def say(text):
    print(text, flush=True)


def warn(text):
    print(text, file=sys.stderr, flush=True)


def progress(text):
    """What is being done: not part of what a command prints."""
    warn(text)
