"""Small drawings of curves and lines, as SVG: no library needed."""

import math
from xml.sax.saxutils import escape

WIDTH, HEIGHT = 760, 540
LEFT, RIGHT, TOP, BOTTOM = 70, 25, 25, 55
COLOURS = ["#1f4e9c", "#c23b22", "#2e7d32", "#7b1fa2", "#b26a00", "#00695c", "#555555"]


class Axis:
    def __init__(self, low, high, log=False):
        self.log = log
        self.low, self.high = self._inner(low), self._inner(high)

    def _inner(self, x):
        return math.log10(x) if self.log else x

    def share(self, x):
        """0 at the low end, 1 at the high one."""
        return (self._inner(x) - self.low) / (self.high - self.low)

    def contains(self, x):
        return (x > 0 or not self.log) and -1e-9 <= self.share(x) <= 1 + 1e-9

    def ticks(self):
        if self.log:
            powers = range(math.floor(self.low), math.ceil(self.high) + 1)
            digits = (1, 2, 3, 5) if self.high - self.low < 1.7 else (1, 2, 5) if self.high - self.low < 2.5 else (1,)
            found = [digit * 10.0 ** power for power in powers for digit in digits]
        else:
            power = 10.0 ** math.floor(math.log10((self.high - self.low) / 6))
            step = next(f * power for f in (1, 2, 5, 10) if (self.high - self.low) / (f * power) <= 7.5)
            found = [round(k * step, 12) for k in range(math.ceil(self.low / step), math.floor(self.high / step + 1e-9) + 1)]
        return [x for x in found if self.contains(x)]


class Panel:
    """A pair of axes in a rectangle of the drawing (in pixels)."""

    def __init__(self, x, y, x_name, y_name, box=(LEFT, TOP, WIDTH - RIGHT, HEIGHT - BOTTOM)):
        self.x, self.y = x, y
        self.box = box
        self.parts = []
        self.taken = []  # rectangles of labels: left, top, right, bottom
        self._frame(x_name, y_name)

    def _at(self, x, y):
        left, top, right, bottom = self.box
        return left + (right - left) * self.x.share(x), bottom - (bottom - top) * self.y.share(y)

    def _add(self, text):
        self.parts.append(text)

    def _frame(self, x_name, y_name):
        left, top, right, bottom = self.box
        self._add(f'<rect x="{left}" y="{top}" width="{right - left}" height="{bottom - top}" fill="none" stroke="black"/>')
        for tick in self.x.ticks():
            at = left + (right - left) * self.x.share(tick)
            self._add(f'<path d="M{at:.1f} {bottom}v-6" stroke="black"/>')
            self._add(f'<text x="{at:.1f}" y="{bottom + 17}" text-anchor="middle">{tick:g}</text>')
        for tick in self.y.ticks():
            at = bottom - (bottom - top) * self.y.share(tick)
            self._add(f'<path d="M{left} {at:.1f}h6" stroke="black"/>')
            self._add(f'<text x="{left - 7}" y="{at + 4.5:.1f}" text-anchor="end">{tick:g}</text>')
        self._add(f'<text x="{(left + right) / 2:.1f}" y="{bottom + 38}" text-anchor="middle" font-size="15">{escape(x_name)}</text>')
        self._add(f'<text transform="translate({left - 48} {(top + bottom) / 2:.1f}) rotate(-90)" text-anchor="middle" '
                  f'font-size="15">{escape(y_name)}</text>')

    def line(self, points, colour, width=1.6, dashes=""):
        """Broken where it leaves the panel."""
        path, pen_up = [], True
        for x, y in points:
            if not (self.x.contains(x) and self.y.contains(y)):
                pen_up = True
                continue
            at = self._at(x, y)
            path.append(f'{"M" if pen_up else "L"}{at[0]:.1f} {at[1]:.1f}')
            pen_up = False
        if path:
            self._add(f'<path fill="none" stroke="{colour}" stroke-width="{width}" stroke-dasharray="{dashes}" d="{"".join(path)}"/>')

    def marks(self, points, colour, radius=3, filled=True):
        for x, y in points:
            if self.x.contains(x) and self.y.contains(y):
                at = self._at(x, y)
                self._add(f'<circle cx="{at[0]:.1f}" cy="{at[1]:.1f}" r="{radius}" stroke="{colour}" '
                          f'fill="{colour if filled else "white"}"/>')

    def bars(self, points, colour):
        """Errors: (x, y, error)."""
        for x, y, error in points:
            ends = [y - error, y + error]
            if self.x.contains(x) and all(self.y.contains(e) for e in ends):
                low, high = self._at(x, ends[0]), self._at(x, ends[1])
                self._add(f'<path d="M{low[0]:.1f} {low[1]:.1f}V{high[1]:.1f}" stroke="{colour}"/>')

    def on_drawing(self, points, step=3.0):
        """The line in pixels, a point every few of them; points outside of the panel are left out."""
        path = [self._at(x, y) for x, y in points if self.x.contains(x) and self.y.contains(y)]
        fine = path[:1]
        for a, b in zip(path, path[1:]):
            pieces = max(1, math.ceil(math.dist(a, b) / step))
            fine += [(a[0] + (b[0] - a[0]) * k / pieces, a[1] + (b[1] - a[1]) * k / pieces) for k in range(1, pieces + 1)]
        return fine

    def label(self, places, text, colour, avoided=(), size=11):
        """At the first of the places (in pixels, the middle of the text) that has room inside the panel, beside all other labels and
        all points to be avoided; whether there is one."""
        left, top, right, bottom = self.box
        half, high = 3.2 * size / 11 * len(text) + 2, 0.5 * size + 1
        for x, y in places:
            x = min(max(x, left + half + 1), right - half - 1)  # lines end at the frame
            box = (x - half, y - high, x + half, y + high)
            if box[1] < top or box[3] > bottom or any(_overlap(box, other) for other in self.taken):
                continue
            if any(box[0] < px < box[2] and box[1] < py < box[3] for px, py in avoided):
                continue
            self.taken.append(box)
            self._add(f'<rect x="{box[0] + 1:.1f}" y="{box[1] + 1:.1f}" width="{2 * half - 2:.1f}" height="{2 * high - 2:.1f}" fill="white"/>')
            self._add(f'<text x="{x:.1f}" y="{y + 0.36 * size:.1f}" text-anchor="middle" font-size="{size}" fill="{colour}">{escape(text)}</text>')
            return True
        return False

    def _sample(self, x, y, colour, dashes):
        """Of a line, or of marks ("open", "filled"), 26 pixels wide."""
        if dashes in ("open", "filled"):
            self._add(f'<circle cx="{x + 13:.1f}" cy="{y:.1f}" r="3" stroke="{colour}" fill="{colour if dashes == "filled" else "white"}"/>')
        else:
            self._add(f'<path d="M{x:.1f} {y:.1f}h26" stroke="{colour}" stroke-width="1.8" stroke-dasharray="{dashes}"/>')

    def legend(self, entries, corner=(0.03, 0.05)):
        """(text, colour, dashes) below each other, from a corner given in shares of the panel; where nothing is drawn."""
        left, top, right, bottom = self.box
        x, y = left + corner[0] * (right - left), top + corner[1] * (bottom - top)
        for text, colour, dashes in entries:
            self._sample(x, y, colour, dashes)
            self._add(f'<text x="{x + 32:.1f}" y="{y + 4.5:.1f}">{escape(text)}</text>')
            y += 18

    def legend_above(self, entries, width=190):
        """Beside each other above the panel."""
        x, y = self.box[0] + 20, self.box[1] - 16
        for text, colour, dashes in entries:
            self._sample(x, y, colour, dashes)
            self._add(f'<text x="{x + 32:.1f}" y="{y + 4.5:.1f}">{escape(text)}</text>')
            x += width


def _overlap(a, b):
    return a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3]


def drawing(*panels, height=HEIGHT):
    parts = [part for panel in panels for part in panel.parts]
    return (f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH}" height="{height}" viewBox="0 0 {WIDTH} {height}" '
            f'font-family="sans-serif" font-size="13">\n<rect width="{WIDTH}" height="{height}" fill="white"/>\n'
            + "\n".join(parts) + "\n</svg>\n")
