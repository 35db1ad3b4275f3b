"""Finds the files of scenes. An experiment may name one that is not part of the project: it is looked for in folders of
SCENES, and may be packed there."""
import contextlib
import functools
import json
import lzma
import os
import shutil

from .errors import SweepError
from .raypool import BUILD, ROOT

BUILT_IN = ("cornell", "room")
# Relative to the project's folder.
DEFAULT_FOLDERS = "scenes:../shared/scenes"


def folders():
    """Those of SCENES, separated by colons as those of PATH are."""
    own = os.environ.get("SCENES")
    if own:
        return [os.path.abspath(folder) for folder in own.split(":") if folder]
    return [os.path.normpath(os.path.join(ROOT, folder)) for folder in DEFAULT_FOLDERS.split(":")]


@functools.lru_cache(maxsize=None)
def find(scene, beside):
    """The path of a scene's file, which stands in the folder `beside` or in one of folders(). If there is none, its
    place in the first."""
    own = os.path.normpath(os.path.join(beside, scene))
    if os.path.exists(own) or os.path.isabs(scene):
        return own
    for folder in folders():
        path = os.path.join(folder, scene)
        if os.path.isfile(path):
            return path
        if os.path.isfile(path + ".xz"):
            return unpacked(path + ".xz")
    return own


def missing(scene, source):
    """The sentence about one that is nowhere."""
    places = (os.path.dirname(scene), *folders())
    shown = " nor in ".join(min(place, os.path.relpath(place), key=len) for place in places)
    more = f"; {source}" if source else ""
    return f"{os.path.basename(scene)} is neither in {shown}{more}; with SCENES=FOLDER it is looked for there"


def unpacked(packed):
    """A copy in the build folder, with what the scene names."""
    scene = os.path.join(BUILD, "scenes", os.path.basename(packed).removesuffix(".xz"))
    try:
        os.makedirs(os.path.dirname(scene), exist_ok=True)
        copy(packed, scene, lzma.open)
        for name in names_in(scene):
            path = os.path.join(os.path.dirname(packed), name)
            if os.path.isfile(path):
                copy(path, os.path.join(os.path.dirname(scene), os.path.basename(name)), open)
    except (OSError, lzma.LZMAError, EOFError, ValueError) as error:
        raise SweepError(f"{packed}: cannot be unpacked into {os.path.dirname(scene)}: {error}") from error
    return scene


def copy(path, to, opened):
    """Unless it is there; whole or not at all."""
    time = os.stat(path).st_mtime_ns
    if os.path.isfile(to) and os.stat(to).st_mtime_ns == time:
        return
    part = f"{to}.{os.getpid()}"
    try:
        with opened(path, "rb") as source, open(part, "wb") as out:
            shutil.copyfileobj(source, out)
        os.utime(part, ns=(time, time))
        os.replace(part, to)
    finally:
        with contextlib.suppress(FileNotFoundError):
            os.unlink(part)


def names_in(scene):
    """The names that a scene's file gives of others: materials of an OBJ, buffers of a glTF."""
    names = []
    if scene.lower().endswith(".obj"):
        with open(scene, encoding="utf-8", errors="replace") as file:
            for line in file:
                if line.startswith("mtllib"):
                    # A name with spaces is one name, or several names.
                    names += [line[6:].strip(), *line.split()[1:]]
    elif scene.lower().endswith(".gltf"):
        with open(scene, encoding="utf-8", errors="replace") as file:
            names = [part.get("uri", "data:") for part in json.load(file).get("buffers", [])]
    return [name for name in names if not name.startswith("data:")]


@functools.lru_cache(maxsize=None)
def files_of(scene):
    """The scene's file and those that it names."""
    paths = {os.path.join(os.path.dirname(scene), name) for name in names_in(scene)}
    return (scene, *sorted(path for path in paths if os.path.isfile(path)))
