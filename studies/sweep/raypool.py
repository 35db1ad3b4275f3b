"""What the program is asked: fields, machines. Its sentences are the user's."""
import hashlib
import json
import os
import subprocess

from .errors import SweepError

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
BUILD = os.path.join(ROOT, os.environ.get("BUILD", "build"))
PROGRAM = os.environ.get("RAYPOOL") or os.path.join(BUILD, "raypool")
VERILATED = ("rtl", "lockstep")


def ask(*arguments):
    """What raypool prints; its sentence as SweepError."""
    done = subprocess.run([PROGRAM, *arguments], cwd=ROOT, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise SweepError(sentence(done.stderr, done.returncode))
    return done.stdout


def sentence(text, code):
    """The last line of an error output, without the program's name."""
    lines = [line for line in text.splitlines() if line.strip()]
    if not lines:
        return f"raypool ended with {'signal' if code < 0 else 'exit code'} {abs(code)} and printed nothing"
    return lines[-1].removeprefix("raypool: ")


def flat(tree, prefix=""):
    """{"alus.flt.count": 1, ...} of nested objects; lists are left out."""
    found = {}
    for key, value in tree.items():
        if isinstance(value, dict):
            found.update(flat(value, f"{prefix}{key}."))
        elif not isinstance(value, list):
            found[prefix + key] = value
    return found


def digest_of_file(path):
    with open(path, "rb") as file:
        return hashlib.sha256(file.read()).hexdigest()


def files_of_shaders(shaders):
    """A shader set's files, and those that every set may include."""
    if shaders == "":
        return []
    own = os.path.join(ROOT, "shaders")
    folder = shaders if os.path.isdir(shaders) else os.path.join(own, shaders)
    files = [os.path.join(place, name) for place, _, names in os.walk(folder) for name in names]
    return sorted([*files, *(os.path.join(own, name) for name in os.listdir(own) if name.endswith(".glsl"))])


def machine_words(config, settings):
    """The options that name a machine."""
    return [f"--config={config}", *(f"--set={field}={value}" for field, value in settings.items())]


def ask_config(config, settings, *options):
    """What raypool config, which takes the name as its argument, prints of a machine that can be."""
    _, *words = machine_words(config, settings)
    return ask("config", config, *words, *options)


def machine(config, settings):
    """The whole configuration, chip included."""
    return json.loads(ask_config(config, settings, "--json"))


def settable_fields():
    return set(flat(machine("8w8c", {}))) - {"name"}
