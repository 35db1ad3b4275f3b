"""Finds the files of scenes. An experiment may name one that is not part of the project: it is looked for in folders of
SCENES, and may be packed there."""
import contextlib
import functools
import json
import lzma
import os
import re
import shutil
import urllib.parse

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
        for path in named_by(scene, os.path.dirname(packed)):
            copy(path, os.path.join(os.path.dirname(scene), os.path.basename(path)), open)
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


def named_by(scene, folder):
    """The files of a folder, or below it, that a scene's file may mean: materials of an OBJ, buffers of a glTF. It may
    be more than raypool reads: a result only depends on those too, then."""
    # Line continuations, with line ends that may be those of Windows; utf-8-sig leaves out a byte order mark.
    with open(scene, encoding="utf-8-sig", errors="surrogateescape") as file:
        if scene.lower().endswith(".obj"):
            libraries = re.findall(r"^\ufeff*[ \t]*mtllib[ \t]+(.*)", re.sub(r"\\[ \t]*\n", " ", file.read()), re.M)
            names = [name for library in libraries for name in possible_names(library)]
        elif scene.lower().endswith(".gltf"):
            uris = [part.get("uri", "data:") for part in json.load(file).get("buffers", [])]
            names = [urllib.parse.unquote(uri) for uri in uris if not uri.startswith("data:")]
        else:
            names = []
    paths = set()
    for name in names:
        # Case does not matter, and a whole path of another machine may mean a file beside the scene.
        for place in {name, name.replace("\\", "/"), re.split(r"[\\/]", name)[-1]}:
            within, last = os.path.split(os.path.join(folder, place))
            with contextlib.suppress(OSError):
                same = [other for other in os.listdir(within or ".") if other.lower() == last.lower()]
                paths |= {os.path.join(within, other) for other in same}
    return sorted(path for path in paths if os.path.isfile(path))


def possible_names(library):
    """A line mtllib has one name, which may have blanks, or several: all words that stand next to each other."""
    words = list(re.finditer(r"\S+", library))
    spans = [(first.start(), last.end()) for at, first in enumerate(words) for last in words[at:]]
    return [library[begin:end].strip('"') for begin, end in spans]


@functools.lru_cache(maxsize=None)
def files_of(scene):
    """The scene's file and those that it names."""
    return (scene, *named_by(scene, os.path.dirname(scene)))
