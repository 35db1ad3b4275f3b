"""What the program is asked: fields, machines, scenes. Its sentences are the user's."""
import hashlib
import json
import os
import subprocess

from .errors import SweepError

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
PROGRAM = os.environ.get("RAYPOOL") or os.path.join(ROOT, os.environ.get("BUILD", "build"), "raypool")
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
        return f"raypool ended with {'signal' if code < 0 else 'exit code'} {abs(code)} and said nothing"
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


def machine_words(config, settings):
    """The options that name a machine."""
    return [f"--config={config}", *(f"--set={field}={value}" for field, value in settings.items())]


def ask_config(config, settings, *options):
    """What raypool config, which takes the name as its argument, says of a machine that can be."""
    _, *words = machine_words(config, settings)
    return ask("config", config, *words, *options)


def machine(config, settings):
    """The whole configuration, chip included."""
    return json.loads(ask_config(config, settings, "--json"))


def settable_fields():
    return set(flat(machine("8w8c", {}))) - {"name"}


def files_of_scene(scene):
    """The scene's file and those that it names: materials of an OBJ, buffers of a glTF."""
    folder = os.path.dirname(scene)
    others = []
    if scene.lower().endswith(".obj"):
        with open(scene, encoding="utf-8", errors="replace") as file:
            for line in file:
                if line.startswith("mtllib"):
                    # A name with spaces is one name, or several names.
                    others += [line[6:].strip(), *line.split()[1:]]
    elif scene.lower().endswith(".gltf"):
        with open(scene, encoding="utf-8", errors="replace") as file:
            others = [part.get("uri", "data:") for part in json.load(file).get("buffers", [])]
    paths = [os.path.join(folder, each) for each in others if not each.startswith("data:")]
    return [scene, *sorted({path for path in paths if os.path.isfile(path)})]
