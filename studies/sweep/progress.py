"""Shows how far a sweep is, like raypool: on a terminal one line that is rewritten, else a line every few seconds."""
import sys
import time


class Progress:
    def __init__(self):
        self.terminal = sys.stderr.isatty()
        self.interval = 0.2 if self.terminal else 5.0
        self.next = time.monotonic() + self.interval
        self.shown = False

    def show(self, text, now=False):
        """When it is time for it, or `now`."""
        if not now and time.monotonic() < self.next:
            return
        self.shown = True
        sys.stderr.write(f"\r\033[K{text}" if self.terminal else text + "\n")
        sys.stderr.flush()
        self.next = time.monotonic() + self.interval

    def clear(self):
        if self.shown and self.terminal:
            print("\r\033[K", end="", file=sys.stderr, flush=True)
        self.shown = False
