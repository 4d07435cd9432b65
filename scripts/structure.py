"""Draw the houses of the project and who imports whom, from the imports themselves.

Usage: structure.py docs/images/structure.svg
"""

from __future__ import annotations

import ast
import sys
from collections.abc import Iterable, Iterator
from functools import cache
from html import escape
from pathlib import Path

ROOT = Path(__file__).parents[1]
FLOORS = (
    ("verification",),
    ("lineofaction.cli",),
    ("lineofaction.hardcases", "lineofaction.client", "lineofaction.validation"),
    ("service",),
    ("lineofaction.report",),
    ("lineofaction.gearbox",),
    ("fe_contact", "dynamics"),
    ("model_studies",),
    ("bounds", "host"),
)
"""Floors of the picture from the top; imports point down."""
HOUSES = tuple(house for floor in FLOORS for house in floor)
PRODUCT = tuple(house for house in HOUSES if house != "verification")
"""The houses in the wheel."""
WIDTH, HEIGHT, BOX, TALL = 760, 78, 200, 40


def house_of(module: str) -> str | None:
    """Return the house that a module belongs to; None of foreign ones, and of the package that names all."""
    return next((house for house in HOUSES if module == house or module.startswith(f"{house}.")), None)


def files_of(house: str) -> list[Path]:
    """Return the files of a house."""
    return sorted((ROOT / house.replace(".", "/")).rglob("*.py"))


def imported(file: Path) -> tuple[str, ...]:
    """Return the names of the modules that a file imports, on demand too."""
    return _imports(file.read_text("utf-8"))


@cache
def _imports(code: str) -> tuple[str, ...]:
    return tuple(_imported(ast.parse(code).body))


def _imported(body: Iterable[ast.AST]) -> Iterator[str]:
    """Yield what statements import; no expression is looked into, where nothing can be imported."""
    for node in body:
        if isinstance(node, ast.ImportFrom) and node.module and not node.level:
            yield from (f"{node.module}.{alias.name}" for alias in node.names)
        elif isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        for inner in ("body", "orelse", "finalbody", "handlers", "cases"):
            yield from _imported(getattr(node, inner, ()))


def arrows() -> set[tuple[str, str]]:
    """Return who imports whom."""
    files = [(house, file) for house in HOUSES for file in files_of(house)]
    found = {(house, house_of(name)) for house, file in files for name in imported(file)}
    return {(one, other) for one, other in found if other is not None and one != other}


def upward() -> list[tuple[str, str]]:
    """Return the arrows that point up, or along a floor: there must be none."""
    floor = {house: number for number, houses in enumerate(FLOORS) for house in houses}
    return sorted((one, other) for one, other in arrows() if floor[one] >= floor[other])


def drawing() -> str:
    """Return the picture as SVG: a box a house, a line an import of others."""
    place = {
        house: (WIDTH * (number + 1) / (len(floor) + 1), 40 + HEIGHT * level)
        for level, floor in enumerate(FLOORS)
        for number, house in enumerate(floor)
    }
    lines = [_line(place[one], place[other]) for one, other in sorted(arrows())]
    boxes = [_box(house, *place[house]) for house in HOUSES]
    size = f'viewBox="0 0 {WIDTH} {HEIGHT * len(FLOORS)}"'
    title = "<title>Houses of lineofaction, from entry points to the bottom; every import points down</title>"
    return "\n".join(
        [f'<svg xmlns="http://www.w3.org/2000/svg" {size}>', title, *lines, *boxes, "</svg>", ""]
    )


def _line(start: tuple[float, float], end: tuple[float, float]) -> str:
    bend = 14 * round((end[1] - start[1]) / HEIGHT - 1) * (1 if start[0] <= end[0] else -1)
    middle = f"{(start[0] + end[0]) / 2 + bend * 4:.0f} {(start[1] + end[1]) / 2:.0f}"
    path = f"M {start[0]:.0f} {start[1]:.0f} Q {middle} {end[0]:.0f} {end[1] - TALL / 2:.0f}"
    return f'<path d="{path}" fill="none" stroke="#8a97a8" stroke-width="1.2"/>'


def _box(house: str, x: float, y: float) -> str:
    corner = f'x="{x - BOX / 2:.0f}" y="{y - TALL / 2:.0f}" width="{BOX}" height="{TALL}" rx="6"'
    text = f'<text x="{x:.0f}" y="{y + 5:.0f}" text-anchor="middle" font-family="sans-serif" font-size="15">'
    return f'<rect {corner} fill="#f3f6fa" stroke="#2d4a6b"/>{text}{escape(house)}</text>'


if __name__ == "__main__":
    Path(sys.argv[1]).write_text(drawing(), encoding="utf-8")
