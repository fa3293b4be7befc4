"""A line on a terminal that says how much of the page is made; nothing where stderr is none."""

import sys
import time

_REDRAW_S = 0.2


class Progress:
    def __init__(self, what, total, stream=None):
        self.stream = stream or sys.stderr
        self.what, self.total, self.done = what, total, 0
        self.start = self.drawn = time.monotonic()
        self.is_shown = total > 0 and self.stream.isatty()

    def advance(self):
        self.done += 1
        now = time.monotonic()
        if not self.is_shown or now < self.drawn + _REDRAW_S:
            return
        self.drawn = now
        left_s = (now - self.start) / self.done * max(0, self.total - self.done)
        self.stream.write(f"\r\033[K{self.what} {self.done}/{self.total}  {left_s:.0f} s left")
        self.stream.flush()

    def end(self):
        if self.is_shown:
            self.stream.write("\r\033[K")
            self.stream.flush()
