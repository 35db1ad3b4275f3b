"""Progress of a command in numbered phases: which of how many, what it does, and about how long where that is known."""
import json
import os
import time

from .errors import progress


def about(seconds):
    """A rough time in words: "20 s", "3 min", "2 h"."""
    if seconds < 90:
        return f"{max(10, 10 * round(seconds / 10))} s"
    if seconds < 90 * 60:
        return f"{round(seconds / 60)} min"
    return f"{round(seconds / 3600)} h"


class Phases:
    """Prints each phase of `planned` (name -> what it does) as it begins. With a folder it keeps there how long each
    one took, which the next run in that folder prints. Notes outside of all phases have no number.
    """

    # What is shorter needs no estimate.
    WORTH_SAYING = 10

    def __init__(self, planned=None, folder=None):
        self.planned = planned or {}
        self.path = os.path.join(folder, "phases.json") if folder else None
        self.took = self._kept()
        self.current = None
        self.begun = time.monotonic()

    def _kept(self):
        try:
            with open(self.path, encoding="utf-8") as file:
                return {name: float(seconds) for name, seconds in json.load(file).items()}
        except (OSError, TypeError, ValueError, AttributeError):
            return {}

    @property
    def label(self):
        names = list(self.planned)
        return f"phase {names.index(self.current) + 1} of {len(names)}" if self.current in self.planned else ""

    def begin(self, name):
        """The phase of this name begins, and the one before it is over. Of a name that is not planned nothing is
        printed.
        """
        self.end()
        if name not in self.planned:
            return
        self.current, self.begun = name, time.monotonic()
        before = self.took.get(name, 0)
        hint = f" (last time {about(before)})" if before >= self.WORTH_SAYING else ""
        progress(f"synth: {self.label}: {self.planned[name]}{hint}")

    def end(self):
        """The current phase is over."""
        if self.current is None:
            return
        self.took[self.current] = round(time.monotonic() - self.begun, 1)
        self.current = None
        if self.path:
            new = f"{self.path}.{os.getpid()}"
            with open(new, "w", encoding="utf-8") as file:
                json.dump(self.took, file)
            os.rename(new, self.path)

    def note(self, text):
        """What happens in the current phase."""
        progress(f"synth: {self.label + ', ' if self.current else ''}{text}")
