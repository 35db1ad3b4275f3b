"""Some signals in some cycles, as a picture in the look of scripts/diagrams. What is of the ray is coloured."""
from diagrams.svg import NAME_WIDTH, NOTE_WIDTH, WIDTH, Picture

LEFT, RIGHT, TOP, ROW, HIGH = 176, 12, 58, 30, 18


class Signals:
    """`rows`: (label, name of the signal, text of a value or None for a bit, {cycle: colour}); `notes`: lines below."""

    def __init__(self, wave, title, cycles, rows, notes):
        self.wave, self.cycles, self.rows = wave, cycles, rows
        self.cell = (WIDTH - LEFT - RIGHT) / len(cycles)
        self.picture = Picture(TOP + ROW * len(rows) + 18 * len(notes) + 16, f"raypool: {title}")
        self.picture.text(16, 24, title, "part")
        self.ruler()
        for number, row in enumerate(rows):
            self.row(TOP + ROW * number, *row)
        for number, note in enumerate(notes):
            self.picture.text(16, TOP + ROW * len(rows) + 18 * number + 16, note)

    def x(self, cycle):
        return LEFT + (cycle - self.cycles[0]) * self.cell

    def ruler(self):
        picture, bottom = self.picture, TOP + ROW * len(self.rows)
        picture.text(16, 46, "cycle")
        every = next(
            step for step in (1, 2, 5, 10, 20) if len(str(self.cycles[-1])) * NOTE_WIDTH + 4 < step * self.cell
        )
        for cycle in self.cycles:
            x = self.x(cycle)
            picture.shapes.append(f'<path d="M{x:.1f} {TOP - 6} V{bottom}" class="grid"/>')
            half = len(str(cycle)) * NOTE_WIDTH / 2
            if cycle % every == 0 and x + self.cell / 2 + half <= WIDTH - 4:
                picture.text(x + self.cell / 2, 46, str(cycle), "wide", "middle")

    def row(self, top, label, name, text, colours):
        self.picture.text(16, top + 18, label, "part")
        values = [self.wave.value(name, cycle) for cycle in self.cycles]
        if text is None:
            self.bit(top, values, colours)
        else:
            self.bus(top, values, text, colours)

    def bit(self, top, values, colours):
        low, high = top + 24, top + 24 - HIGH
        path, before = "", None
        for cycle, value in zip(self.cycles, values):
            y = high if value else low
            if value and cycle in colours:
                self.picture.rectangle(round(self.x(cycle), 1), high, round(self.cell, 1), HIGH, colours[cycle], 0)
            path += f"M{self.x(cycle):.1f} {y}" if before is None else f" V{y}" if y != before else ""
            path += f" H{self.x(cycle + 1):.1f}"
            before = y
        self.picture.shapes.append(f'<path d="{path}" class="wire"/>')

    def bus(self, top, values, text, colours):
        """A box for each run of one value and colour."""
        runs = []
        for cycle, value in zip(self.cycles, values):
            if runs and runs[-1][1:] == [value, colours.get(cycle)]:
                runs[-1][0].append(cycle)
            else:
                runs.append([[cycle], value, colours.get(cycle)])
        for cycles, value, colour in runs:
            left, right = self.x(cycles[0]), self.x(cycles[-1] + 1)
            y, middle, end = top + 24 - HIGH, top + 24 - HIGH / 2, min(4, self.cell / 4)
            shape = f"M{left:.1f} {middle} L{left + end:.1f} {y} H{right - end:.1f} L{right:.1f} {middle} "
            shape += f"L{right - end:.1f} {y + HIGH} H{left + end:.1f} Z"
            if colour:
                self.picture.shapes.append(f'<path d="{shape}" class="{colour}"/>')
            self.picture.shapes.append(f'<path d="{shape}" class="wire"/>')
            words = text(value, cycles[0])
            for kind, letter in (("part", NAME_WIDTH), ("wide", NOTE_WIDTH)):
                if len(words) * letter < right - left - 6 and (colour or kind == "wide"):
                    self.picture.text((left + right) / 2, middle + 4, words, kind, "middle")
                    break
