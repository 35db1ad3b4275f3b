"""A picture of boxes and wires as SVG, with a plate of its own and colours for light and dark readers.

Module names stand in a font of one width, so that what would not fit its box is found here and not by the eye; so is a
line that crosses words. Every name that a picture shows as a module is kept in Picture.modules.
"""
import html

WIDTH = 900  # of every picture, in pixels at which letters have the size below
NAME, NOTE = 12.5, 11.5
NAME_WIDTH, NOTE_WIDTH = 0.61 * NAME, 0.54 * NOTE  # of a letter; of notes, which are proportional, on the safe side

STYLE = """
  .plate { fill: #ffffff; stroke: #d0d4da }
  .box { fill: #eef3fb; stroke: #44618f }
  .box.memory { fill: #f3efe3; stroke: #86702f }
  .group { fill: #f9fafc; stroke: #9aa5b5 }
  .wire { fill: none; stroke: #55606e; stroke-width: 1.3 }
  .head { fill: #55606e }
  text { fill: #1c2127; font: 11.5px 'DejaVu Sans', Verdana, sans-serif }
  text.name { font: bold 12.5px 'DejaVu Sans Mono', Menlo, Consolas, monospace }
  text.part { font: 12.5px 'DejaVu Sans Mono', Menlo, Consolas, monospace }
  text.wide { fill: #4a5461 }
  .c0 { fill: #bcd7f7 } .c1 { fill: #f8d3a4 } .c2 { fill: #c5e5b8 } .c3 { fill: #f4bfc4 } .c4 { fill: #dacbf0 }
  .waits { fill-opacity: 0.35; stroke: #8a939e; stroke-dasharray: 2 2 }
  .grid { stroke: #e3e6ea; stroke-width: 1 }
"""
DARK = """
  .plate { fill: #15191e; stroke: #3a424c }
  .box { fill: #1f2d42; stroke: #7ea2d8 }
  .box.memory { fill: #332d1a; stroke: #c2a75a }
  .group { fill: #1a1f26; stroke: #5a6676 }
  .wire { stroke: #a9b4c1 }
  .head { fill: #a9b4c1 }
  text { fill: #e8ebef }
  text.wide { fill: #b4bdc8 }
  .c0 { fill: #2f5688 } .c1 { fill: #7d5418 } .c2 { fill: #38652a } .c3 { fill: #83343c } .c4 { fill: #57418a }
  .waits { stroke: #98a3b0 }
  .grid { stroke: #2a3038 }
"""


class DiagramError(Exception):
    pass


class Picture:
    """Shapes in the order in which they are drawn. Coordinates are pixels."""

    def __init__(self, height, title):
        self.height, self.title = height, title
        self.shapes, self.modules = [], set()
        self.words, self.lines = [], []  # (left, top, right, bottom, words) and (x0, y0, x1, y1): none may meet
        self.rectangle(0.5, 0.5, WIDTH - 1, height - 1, "plate")

    def rectangle(self, x, y, width, height, kind, radius=6):
        self.shapes.append(
            f'<rect x="{x:g}" y="{y:g}" width="{width:g}" height="{height:g}" rx="{radius:g}" ' f'class="{kind}"/>'
        )

    def text(self, x, y, words, kind="wide", anchor="start"):
        """`y` is the line on which the letters stand."""
        size = len(words) * (NOTE_WIDTH if kind == "wide" else NAME_WIDTH)
        left = x - {"start": 0, "middle": size / 2, "end": size}[anchor]
        if left < 4 or left + size > WIDTH - 4 or y > self.height - 4:
            raise DiagramError(f"{self.title}: '{words}' does not fit the picture")
        self.words.append((left, y - 10, left + size, y + 2, words))
        self.shapes.append(
            f'<text x="{x:g}" y="{y:g}" class="{kind}" text-anchor="{anchor}">' f"{html.escape(words)}</text>"
        )

    def box(self, place, name, notes=(), kind="box", parts=(), times=""):
        """A module: its name, what it holds (`parts`, modules too), notes. `place` is x, y, width, height."""
        x, y, width, height = place
        lines = [(name + times, "name")] + [(part, "part") for part in parts] + [(note, "wide") for note in notes]
        for words, line_kind in lines:
            if len(words) * (NOTE_WIDTH if line_kind == "wide" else NAME_WIDTH) > width - 8:
                raise DiagramError(f"{self.title}: '{words}' does not fit its box")
        if 17 * len(lines) + 4 > height:
            raise DiagramError(f"{self.title}: the box of {name} is too low for {len(lines)} lines")
        self.rectangle(x, y, width, height, kind)
        top = y + (height - 17 * len(lines)) / 2 + 13
        for number, (words, line_kind) in enumerate(lines):
            self.text(x + width / 2, top + 17 * number, words, line_kind, "middle")
        self.modules |= {name} | {part.split(" ")[0] for part in parts}

    def group(self, place, name="", note="", copies=0):
        """A frame around boxes; `copies` frames behind it show that there are several."""
        x, y, width, height = place
        for copy in range(copies, 0, -1):
            self.rectangle(x + 4 * copy, y + 4 * copy, width, height, "group")
        self.rectangle(x, y, width, height, "group")
        if name:
            self.text(x + 10, y + 18, name, "name")
            self.modules.add(name)
        if note:
            self.text(x + 10 + (len(name) + 1) * NAME_WIDTH, y + 18, note)

    def line(self, *points):
        """Along the points."""
        for (x0, y0), (x1, y1) in zip(points, points[1:]):
            if x0 != x1 and y0 != y1:
                raise DiagramError(f"{self.title}: the line from {x0:g}, {y0:g} to {x1:g}, {y1:g} is aslant")
            self.lines.append((min(x0, x1), min(y0, y1), max(x0, x1), max(y0, y1)))
        self.shapes.append('<path d="M' + " L".join(f"{x:g} {y:g}" for x, y in points) + '" class="wire"/>')

    def wire(self, *points, both=False):
        """A line with an arrow at the last point, or `both` ends."""
        self.line(*points)
        self.head(points[-2], points[-1])
        if both:
            self.head(points[1], points[0])

    def head(self, before, end):
        (x0, y0), (x, y) = before, end
        along = ((x > x0) - (x < x0), (y > y0) - (y < y0))
        back, aside = (x - 7 * along[0], y - 7 * along[1]), (3.5 * along[1], 3.5 * along[0])
        corners = [(x, y), (back[0] + aside[0], back[1] + aside[1]), (back[0] - aside[0], back[1] - aside[1])]
        self.shapes.append('<path d="M' + " L".join(f"{a:g} {b:g}" for a, b in corners) + ' Z" class="head"/>')

    def check(self):
        for left, top, right, bottom, words in self.words:
            for x0, y0, x1, y1 in self.lines:
                if x0 < right and x1 > left and y0 < bottom and y1 > top:
                    place = f"{x0:g}, {y0:g} to {x1:g}, {y1:g}"
                    raise DiagramError(f"{self.title}: the line from {place} crosses '{words}'")

    def svg(self):
        self.check()
        return (
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {self.height}" width="{WIDTH}" '
            f'height="{self.height}" role="img">\n<title>{html.escape(self.title)}</title>\n<style>{STYLE}'
            f"@media (prefers-color-scheme: dark) {{{DARK}}}\n</style>\n" + "\n".join(self.shapes) + "\n</svg>\n"
        )
