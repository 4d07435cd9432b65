"""Draw the glossary: which end misalignment opens, how a gear lags, where the axes point.

python scripts/drawings.py        writes docs/images/glossary/*.svg
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from fe_contact.flank.relief_shape import SHAPES

FOLDER = Path(__file__).parents[1] / "docs" / "images" / "glossary"
INK, SOFT, STRONG = "#24323f", "#8a97a3", "#c2571a"
_DEEP = 0.7
"""Depth of the drawn arc over its length; an arc of usual depth is drawn like the parabola."""
_HEAD = (
    '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {0} {1}" width="{0}" height="{1}" '
    'font-family="sans-serif" font-size="14">'
    '<defs><marker id="a" viewBox="0 0 10 10" refX="9" refY="5" markerWidth="8" markerHeight="8" '
    'orient="auto-start-reverse"><path d="M0 0L10 5L0 10z" fill="context-stroke"/></marker></defs>'
    '<rect width="100%" height="100%" fill="#ffffff"/>'
)


def line(x: tuple[float, float], y: tuple[float, float], color: str = INK, style: str = "") -> str:
    """Draw a straight line; `style` adds attributes."""
    return f'<path d="M{x[0]} {y[0]}L{x[1]} {y[1]}" stroke="{color}" stroke-width="2" fill="none" {style}/>'


def path(data: str, color: str = INK, style: str = "") -> str:
    """Draw a path."""
    return f'<path d="{data}" stroke="{color}" stroke-width="2" fill="none" {style}/>'


def text(x: float, y: float, words: str, color: str = INK, anchor: str = "start") -> str:
    """Write words."""
    return f'<text x="{x}" y="{y}" fill="{color}" text-anchor="{anchor}">{words}</text>'


ARROW, BOTH, DASHED = (
    'marker-end="url(#a)"',
    'marker-start="url(#a)" marker-end="url(#a)"',
    'stroke-dasharray="6 5"',
)


def misalignment() -> str:
    """Draw the plane of action: the gap grows towards positive z, the other end carries."""
    return "".join(
        (
            _HEAD.format(620, 270),
            text(20, 26, "Plane of action, positive misalignment"),
            path("M90 150H530V215H90Z", INK, 'style="fill:#e6ebf0"'),
            text(310, 205, "flank of the pinion (drives)", anchor="middle"),
            path("M90 172L530 128V60H90Z", INK, 'style="fill:#f6e9de;fill-opacity:.8"'),
            text(310, 95, "flank of the wheel", anchor="middle"),
            line((310, 310), (36, 190), SOFT, DASHED),
            text(316, 48, "mid-face: no change", SOFT),
            line((545, 545), (128, 150), STRONG, BOTH),
            text(556, 136, "gap", STRONG),
            text(556, 154, "+ m/2", STRONG),
            line((75, 75), (150, 172), STRONG, BOTH),
            text(66, 158, "- m/2", STRONG, "end"),
            text(66, 176, "carries", STRONG, "end"),
            line((90, 530), (245, 245), INK, ARROW),
            text(536, 250, "z"),
            text(92, 262, "z &lt; 0", SOFT),
            text(500, 262, "z &gt; 0", SOFT),
            "</svg>",
        )
    )


def transmission_error() -> str:
    """Draw both gears seen from +z: the driven gear lags by STE along the line of action."""
    return "".join(
        (
            _HEAD.format(620, 300),
            text(20, 26, "Seen from +z"),
            '<circle cx="170" cy="165" r="80" fill="#e6ebf0" stroke="#24323f" stroke-width="2"/>',
            '<circle cx="400" cy="165" r="120" fill="#f6e9de" stroke="#24323f" stroke-width="2"/>',
            text(170, 195, "1 drives", anchor="middle"),
            text(400, 215, "2 is driven", anchor="middle"),
            path("M120 135A58 58 0 0 1 220 135", INK, ARROW),
            path("M460 105A85 85 0 0 0 340 105", INK, ARROW),
            line((400, 400), (165, 50), SOFT, DASHED),
            text(400, 36, "rigid, exact gears", SOFT, "end"),
            line((400, 432), (165, 46), STRONG),
            text(440, 42, "driven gear", STRONG),
            path("M401 52A114 114 0 0 1 429 55", STRONG, ARROW),
            text(500, 80, "lags: STE &gt; 0", STRONG),
            "</svg>",
        )
    )


def axes() -> str:
    """Draw a shaft of a scene with its axes."""
    return "".join(
        (
            _HEAD.format(620, 240),
            text(20, 26, "A scene: shafts are parallel to z"),
            path("M110 110H430V140H110Z", INK, 'style="fill:#e6ebf0"'),
            path("M240 70H290V180H240Z", INK, 'style="fill:#f6e9de"'),
            text(265, 200, "gear", anchor="middle"),
            path("M130 140L118 165H142Z"),
            path("M410 140L398 165H422Z"),
            text(130, 184, "bushing", anchor="middle"),
            text(410, 184, "bushing", anchor="middle"),
            line((110, 520), (125, 125), STRONG, ARROW),
            text(528, 130, "z", STRONG),
            line((110, 110), (125, 55), STRONG, ARROW),
            text(96, 54, "y", STRONG),
            line((110, 158), (125, 84), STRONG, ARROW),
            text(162, 60, "x, away from you", STRONG),
            text(110, 228, "left end: origin_mm, position_mm = 0", SOFT),
            "</svg>",
        )
    )


def flank_modifications() -> str:
    """Draw the shapes of a relief over its length, and where on a flank reliefs and crownings act."""
    return "".join((_HEAD.format(760, 300), *_shapes(60, 250), *_flank(400, 250), "</svg>"))


def _shapes(left: float, low: float) -> Iterator[str]:
    """Draw the depth of every shape, from the start of a relief to its end."""
    size, fraction = 200.0, np.linspace(0.0, 1.0, 41)
    yield text(left - 40, 26, "Shapes of a relief")
    yield line((left, left + size + 20), (low, low), INK, ARROW)
    yield line((left, left), (low, low - size - 15), INK, ARROW)
    yield text(left + size, low + 20, "end", SOFT, "middle")
    yield text(left, low + 20, "start", SOFT, "middle")
    yield text(left - 8, low - size + 5, "C", SOFT, "end")
    colors = (INK, STRONG, STRONG, "#2a7f9e", "#6a4c93")
    for (name, law), color in zip(SHAPES.items(), colors, strict=True):
        depth = law(fraction, _DEEP)
        points = (f"{left + size * u:.1f} {low - size * d:.1f}" for u, d in zip(fraction, depth, strict=True))
        yield path(f"M{'L'.join(points)}", color, DASHED if name == "circular" else "")
    for row, (name, color) in enumerate(reversed(tuple(zip(SHAPES, colors, strict=True)))):
        yield text(left + 14, low - size + 8 + 18 * row, name, color)


def _flank(left: float, low: float) -> Iterator[str]:
    """Draw the flank of a right-hand gear, root below, with the ends that reliefs run to."""
    wide, high, soft = 320, 190, 'style="fill:#f6e9de"'
    yield text(left, 26, "Flank of a right-hand gear")
    yield path(f"M{left} {low}h{wide}v{-high}h{-wide}Z", INK, 'style="fill:#e6ebf0"')
    yield path(f"M{left} {low - high}h{wide}v34h{-wide}Z", SOFT, soft)
    yield path(f"M{left} {low}v{-high}h30v{high}Z", SOFT, soft)
    yield path(f"M{left + wide} {low - high}h-90l90 70Z", STRONG, 'style="fill:#f3d3bd"')
    yield path(f"M{left} {low}h90l-90 -70Z", STRONG, 'style="fill:#f3d3bd"')
    yield line((left + 70, left + 264), (low - 151, low), STRONG, DASHED)
    yield text(left + 150, low - 100, "line of contact", STRONG)
    yield text(left + 110, low - high + 22, "tip relief", anchor="middle")
    yield text(left + 38, low - 100, "end relief,")
    yield text(left + 38, low - 84, "datum face")
    yield text(left + wide - 6, low - high + 22, "triangular", anchor="end")
    yield text(left + 4, low - 8, "triangular")
    yield text(left + 150, low - 8, "root", SOFT)
    yield text(left, low + 20, "datum face (I), -z", SOFT)
    yield text(left + wide, low + 20, "non-datum face (II), +z", SOFT, "end")


def main() -> None:
    """Write all drawings."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    for draw in (misalignment, transmission_error, axes, flank_modifications):
        (FOLDER / f"{draw.__name__}.svg").write_text(draw() + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
