"""What is wrong in a user's input, in one sentence; and the running of tools."""
import shutil
import subprocess


class FollowError(Exception):
    """Bad input, a missing tool, or a waveform that is not what it should be; its text is the message for the user."""


def need(tool, package):
    if shutil.which(tool) is None:
        raise FollowError(f"{tool} was not found: install the Debian package {package} (scripts/setup.sh follow)")
    return tool


def run(command):
    """What a command prints. Its own sentence, when it fails."""
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        said = (done.stderr or done.stdout).strip()
        raise FollowError(said or f"{command[0]} ended with {done.returncode}, and printed nothing")
    return done.stdout


def build(command):
    """Runs what may take minutes. What it prints meanwhile is shown, but is no part of what follow prints."""
    done = subprocess.run([str(word) for word in command], stdout=2, stderr=subprocess.PIPE, text=True, check=False)
    if done.returncode != 0:
        raise FollowError(done.stderr.strip() or f"{command[0]} ended with {done.returncode}, and printed nothing")
