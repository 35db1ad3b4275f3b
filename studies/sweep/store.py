"""What a sweep's folder holds, and which processes may write in it.

points/KEY/    report.json, image.png, point.json, log.txt of a finished point; comes there as a whole, by renaming
failed/KEY/    log.txt and error.txt of a point that failed when it was last tried
starts.log     a line for each start and each finish of a point
table.json     all points of the experiment that are finished, table.csv the same, times.csv what each took
.work/         what is under way: one file a point to do, one lock a point, folders of unfinished points
"""
import contextlib
import errno
import fcntl
import json
import os

from .errors import SweepError


class Store:
    def __init__(self, folder):
        self.folder = os.path.abspath(folder)
        for name in ("points", "failed", ".work/plan", ".work/locks", ".work/unfinished", ".work/done"):
            try:
                os.makedirs(self.path(name), exist_ok=True)
            except OSError as error:
                raise SweepError(f"{folder}: the results cannot be written there: {error.strerror}") from error

    def path(self, *names):
        return os.path.join(self.folder, *names)

    def finished(self, key):
        return os.path.isfile(self.path("points", key, "point.json"))

    def failure(self, key):
        """The sentence of a point that failed, or None."""
        try:
            with open(self.path("failed", key, "error.txt"), encoding="utf-8") as file:
                return file.read().strip()
        except OSError:
            return None

    @contextlib.contextmanager
    def locked(self, name, wait=True):
        """Until the end of the block no other process has this lock; the system takes it back when one is killed."""
        with open(self.path(".work/locks", name), "a", encoding="utf-8") as file:
            try:
                fcntl.flock(file, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB))
            except OSError as error:
                if error.errno not in (errno.EAGAIN, errno.EACCES):
                    raise
                raise SweepError(
                    f"{self.folder}: another sweep is running in this folder: wait for it, or choose another OUT"
                ) from error
            yield

    def log(self, word, key):
        with open(self.path("starts.log"), "a", encoding="utf-8") as file:
            file.write(f"{word} {key}\n")


def write_whole(path, text):
    """The file is there with all its text, or as it was."""
    with open(path + ".new", "w", encoding="utf-8") as file:
        file.write(text)
    os.replace(path + ".new", path)


def write_json(path, document):
    write_whole(path, json.dumps(document, indent=1) + "\n")
