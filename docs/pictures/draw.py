"""Draws the pictures of the explanation and architecture pages: python docs/pictures/draw.py

Plain SVG written by hand, so the files are the same with every version of everything.
"""

from __future__ import annotations

from pathlib import Path
from xml.sax.saxutils import escape

HERE = Path(__file__).parent
INK, GREY, BLUE, ORANGE, GREEN = "#1b1f24", "#6e7781", "#0072b2", "#d55e00", "#009e73"
USES = ("sweep", "design", "tolerance", "verify", "compare", "infer", "measure", "calibrate")


class Drawing:
    """Shapes on a white sheet, in pixels, y down."""

    def __init__(self, width: int, height: int, says: str) -> None:
        self.parts = [
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" role="img" '
            f'font-family="DejaVu Sans, Helvetica, Arial, sans-serif" font-size="15">',
            f"<title>{escape(says)}</title>",
            '<defs><marker id="tip" viewBox="0 0 10 10" refX="9" refY="5" markerWidth="7" markerHeight="7" '
            'orient="auto-start-reverse"><path d="M0,0 L10,5 L0,10 z" fill="context-stroke"/></marker>'
            "</defs>",
            f'<rect width="{width}" height="{height}" fill="white"/>',
        ]

    def box(self, x: float, y: float, w: float, h: float, fill: str = "none", ink: str = INK) -> None:
        """A rectangle."""
        self.parts.append(
            f'<rect x="{x}" y="{y}" width="{w}" height="{h}" rx="3" fill="{fill}" stroke="{ink}"/>'
        )

    def line(self, a: tuple[float, float], b: tuple[float, float], ink: str = INK, ends: str = "") -> None:
        """A line; `ends` holds ``>`` for a tip at b, ``<`` for one at a, ``-`` for dashes."""
        more = ' marker-end="url(#tip)"' if ">" in ends else ""
        more += ' marker-start="url(#tip)"' if "<" in ends else ""
        more += ' stroke-dasharray="5 4"' if "-" in ends else ""
        self.parts.append(
            f'<line x1="{a[0]}" y1="{a[1]}" x2="{b[0]}" y2="{b[1]}" stroke="{ink}" stroke-width="1.6"{more}/>'
        )

    def dot(self, x: float, y: float, ink: str = INK, r: float = 4) -> None:
        """A filled circle."""
        self.parts.append(f'<circle cx="{x}" cy="{y}" r="{r}" fill="{ink}"/>')

    def shape(self, points: str, fill: str) -> None:
        """A filled polygon."""
        self.parts.append(f'<polygon points="{points}" fill="{fill}"/>')

    def text(self, x: float, y: float, says: str, ink: str = INK, at: str = "start", size: int = 15) -> None:
        """A line of text; `at` is start, middle or end."""
        weight = ' font-weight="bold"' if says.startswith("*") else ""
        says = escape(says.removeprefix("*"))
        self.parts.append(
            f'<text x="{x}" y="{y}" fill="{ink}" text-anchor="{at}" font-size="{size}"{weight}>{says}</text>'
        )

    def svg(self) -> str:
        """The file."""
        return "\n".join([*self.parts, "</svg>", ""])


def pixels() -> str:
    """Where pixel coordinates begin, and where an image's middle is."""
    d = Drawing(760, 400, "Pixel coordinates: an integer is the centre of a pixel")
    x0, y0, s, columns, rows = 130, 110, 70, 6, 3
    d.shape(f"{x0},{y0} {x0 + s},{y0} {x0 + s},{y0 + s} {x0},{y0 + s}", "#d7e8f5")
    for i in range(columns + 1):
        d.line((x0 + i * s, y0), (x0 + i * s, y0 + rows * s), GREY)
    for j in range(rows + 1):
        d.line((x0, y0 + j * s), (x0 + columns * s, y0 + j * s), GREY)
    for i in range(columns):
        d.text(x0 + (i + 0.5) * s, y0 - 12, f"{i}", at="middle")
        for j in range(rows):
            d.dot(x0 + (i + 0.5) * s, y0 + (j + 0.5) * s, r=2.5)
    for j in range(rows):
        d.text(x0 - 12, y0 + (j + 0.5) * s + 5, f"{j}", at="end")
    d.line((x0, 50), (x0 + columns * s, 50), INK, ">")
    d.text(x0 + columns * s + 8, 55, "u")
    d.line((55, y0), (55, y0 + rows * s), INK, ">")
    d.text(50, y0 + rows * s + 22, "v")
    d.dot(x0 + 3 * s, y0 + 1.5 * s, ORANGE, 5)
    d.text(x0 + 3 * s + 9, y0 + 1.5 * s - 9, "cx = 2.5, cy = 1", ORANGE)
    low = y0 + rows * s
    d.line((x0, low), (x0, low + 22), BLUE)
    d.text(x0, low + 40, "u = −0.5", BLUE, "middle")
    d.line((x0 + columns * s, low), (x0 + columns * s, low + 22), BLUE)
    d.text(x0 + columns * s, low + 40, "u = 5.5", BLUE, "middle")
    d.text(x0 + 3 * s, low + 70, "width = 6:  cx = (width − 1) / 2 = 2.5, not width / 2", at="middle")
    d.text(x0 + columns * s + 18, y0 + 24, "(0, 0) is the centre", BLUE, size=13)
    d.text(x0 + columns * s + 18, y0 + 42, "of the blue pixel", BLUE, size=13)
    return d.svg()


def frames() -> str:
    """A rectified rig from above: axes, baseline, depth, and the rig's own frame."""
    d = Drawing(760, 485, "A rectified rig from above: camera axes, baseline, depth, disparity, rig frame")
    left, right, base, point = (230, 390), (450, 390), 390, (400, 90)
    middle = (340, 390)
    for x, _ in (left, right):
        d.shape(f"{x},{base} {x - 26},{base + 26} {x + 26},{base + 26}", "#d0d7de")
        d.line((x, base), (x, 60), GREY, "-")
    d.line(left, (left[0], base - 90), BLUE, ">")
    d.text(left[0] - 10, base - 84, "z", BLUE, "end")
    d.line(left, (left[0] + 80, base), BLUE, ">")
    d.text(left[0] + 70, base + 20, "x", BLUE)
    d.text(left[0] - 36, base + 8, "y: into the page", BLUE, "end", 13)
    d.line(left, point, ORANGE)
    d.line(right, point, ORANGE)
    d.dot(*point, ORANGE, 6)
    d.text(point[0] + 12, point[1] - 6, "point (X, Y, Z) of the left camera", ORANGE)
    d.line((130, base), (130, point[1]), INK, "<>")
    d.line((130, point[1]), point, GREY, "-")
    d.text(120, 245, "Z, the depth", at="end")
    d.text(120, 264, "(not the ray)", at="end", size=13)
    d.line((left[0], 450), (right[0], 450), INK, "<>")
    d.text(340, 470, "baseline", at="middle")
    d.dot(*middle, GREEN)
    d.line(middle, (middle[0], base - 70), GREEN, ">")
    d.text(middle[0] + 8, base - 55, "rig frame", GREEN, size=13)
    d.text(left[0], base + 44, "left, the reference", at="middle", size=13)
    d.text(right[0], base + 44, "right", at="middle", size=13)
    d.text(478, 250, "disparity = u_left − u_right", size=14)
    d.text(478, 274, "Z = fx · baseline / (disparity + doffs)", size=14)
    d.text(478, 298, "doffs = cx_right − cx_left", size=14)
    return d.svg()


def mount() -> str:
    """How a rig sits on a body or site, and on a camera, of a scene."""
    d = Drawing(760, 300, "The rig on a mount: a body or site looks along its +X, a camera along its own -Z")
    d.text(190, 32, "*mount on a body or site", at="middle")
    d.text(560, 32, "*mount on a camera", at="middle")
    for x0, ahead, up, side in ((190, "+X", "+Z", "+Y"), (560, "−Z", "+Y", "−X")):
        o = (x0, 190)
        d.line(o, (x0 + 120, 130), BLUE, ">")
        d.text(x0 + 126, 128, f"{ahead}: looks", BLUE)
        d.line(o, (x0, 80), GREEN, ">")
        d.text(x0 + 8, 84, f"{up}: up", GREEN)
        d.line(o, (x0 - 110, 150), ORANGE, ">")
        d.text(x0 - 60, 132, f"{side}: left", ORANGE, "end")
        d.box(x0 - 60, 160, 26, 18, "#d0d7de")
        d.box(x0 + 36, 198, 26, 18, "#d0d7de")
        d.line((x0 - 47, 169), (x0 + 49, 207), GREY, "-")
        d.text(x0 - 66, 196, "left", at="end", size=13)
        d.text(x0 + 70, 220, "right", size=13)
        d.dot(*o)
    d.text(380, 268, "The mount is the rig frame's origin: the middle of the baseline.", at="middle", size=14)
    return d.svg()


def house() -> str:
    """The floors and the use cases."""
    d = Drawing(960, 610, "The house: floors from cli down to rig, use cases from sweep to calibrate")
    d.text(20, 30, "floor", GREY, size=13)
    d.text(222, 30, "shared by all", GREY, size=13)
    d.text(400, 30, "use case", GREY, size=13)
    floors = (
        ("cli", "words → one call", ("kit",), "#f6f8fa"),
        ("api", "arguments → one result", ("kit",), "#f6f8fa"),
        ("present", "values → people", ("kit",), "#e7f1f9"),
        ("interop", "values ↔ files", ("formats, files, exec,", "documents"), "#e7f1f9"),
        ("study", "experiments, verdicts", ("scene, triangulators,", "agreement, calc"), "#e6f5ef"),
    )
    y = 44.0
    for name, what, shared, fill in floors:
        d.box(12, y, 936, 56, fill)
        d.text(24, y + 24, f"*{name}")
        d.text(24, y + 44, what, GREY, size=13)
        d.box(212, y + 7, 168, 42, "white", GREY)
        for i, line in enumerate(shared):
            middle = 33 if len(shared) == 1 else 25 + 17 * i
            d.text(296, y + middle, line, at="middle", size=13)
        for i, use in enumerate(USES):
            d.box(390 + 69.5 * i, y + 7, 66, 42, "white", GREY)
            d.text(423 + 69.5 * i, y + 33, use, at="middle", size=12)
        y += 56 + (2 if name == "present" else 12)
    rooms = (
        ("theory", "what should happen", "predicted", "numpy only", BLUE),
        ("sim", "what does happen", "simulated", "alone imports mujoco", ORANGE),
        ("pixels", "what pictures say", "measured", "alone imports cv2", GREEN),
    )
    for i, (name, what, witness, imports, ink) in enumerate(rooms):
        x = 12 + 316 * i
        d.box(x, y, 304, 84, "white", ink)
        d.text(x + 14, y + 26, f"*{name}", ink)
        d.text(x + 14, y + 47, what, GREY, size=13)
        d.text(x + 290, y + 26, f"witness: {witness}", ink, "end", 13)
        d.text(x + 14, y + 70, imports, INK, size=13)
    y += 96
    d.box(12, y, 936, 48, "#fff5eb")
    d.text(24, y + 30, "*rig")
    holds = "what a rig is: poses, lenses, sensors, two cameras, perturbation, noise, presets"
    d.text(64, y + 30, holds, GREY)
    rule = "A floor imports the floors below it, never beside it or above it."
    d.text(480, y + 76, rule, INK, "middle", 14)
    return d.svg()


DRAWINGS = {"pixels.svg": pixels, "frames.svg": frames, "mount.svg": mount, "house.svg": house}


if __name__ == "__main__":
    for file, draw in DRAWINGS.items():
        (HERE / file).write_text(draw(), encoding="utf-8")
