"""Draw the glossary: which end misalignment opens, how a gear lags, where the axes point.

python scripts/drawings.py        writes docs/images/glossary/*.svg
"""

from __future__ import annotations

from pathlib import Path

FOLDER = Path(__file__).parents[1] / "docs" / "images" / "glossary"
INK, SOFT, STRONG = "#24323f", "#8a97a3", "#c2571a"
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


def main() -> None:
    """Write all drawings."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    for draw in (misalignment, transmission_error, axes):
        (FOLDER / f"{draw.__name__}.svg").write_text(draw() + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
