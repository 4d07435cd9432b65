"""Contact lines of all pairs in the plane of action, with the line load they carry."""

from __future__ import annotations

import math

import numpy as np

from fe_contact.analysis import LoadDistribution
from fe_contact.types import IntArray
from lineofaction.report.drawing.figure import (
    Axis,
    Figure,
    FloatArray,
    Panel,
    Reference,
    Strokes,
    Table,
    number,
)
from lineofaction.report.tables.unrolled import face_axis

SHOWN = 8  # positions


def contact_lines(flanks: LoadDistribution) -> Figure:
    """Draw contact lines at positions spread over the cycle, and those of the largest pressure alone."""
    worst = int(flanks.pressure.max(axis=(1, 2)).argmax())
    step = max(flanks.position.size // SHOWN, 1)
    chosen = np.arange(0, flanks.position.size, step)
    load = _strokes(flanks, chosen, 1e-3 * flanks.line_load, "line load, N/mm")
    pressure = _strokes(flanks, np.array([worst]), 1e-6 * flanks.pressure, "Hertz pressure, MPa")
    at = f"{flanks.position[worst]:.3g}"
    x, y = _axes(flanks)
    return Figure(
        key="contact_lines",
        title="Contact lines in the plane of action",
        caption="Where the tooth pairs touch: face across, path of contact upwards from the pinion's root "
        "(A) to its tip (E). Color and thickness: line load; thin gray: flanks that could touch "
        "but carry no load. "
        f"{_strip(flanks)}",
        alternative=f"At most {number(float(1e-3 * flanks.line_load.max()), 4)} N/mm; at position {at}, the "
        f"one of the largest pressure, {_carrying(flanks, worst)} tooth pairs carry load.",
        content=(
            Panel(x, y, (), _marks(flanks), f"line load at {chosen.size} positions of the cycle", load),
            Panel(x, y, (), _marks(flanks), f"pressure at position {at}, where it is largest", pressure),
        ),
        table=_table(flanks, chosen),
    )


def _axes(flanks: LoadDistribution) -> tuple[Axis, Axis]:
    """Face and path of contact, mm."""
    start, *_, end = (1e3 * point for point in flanks.scene.path_of_contact)
    room = 0.06 * (end - start)
    return (
        face_axis(flanks),
        Axis("roll length of the pinion, mm", limits=(start - room, end + 1.5 * room)),
    )


def _marks(flanks: LoadDistribution) -> tuple[Reference, ...]:
    """Mark A, C, E, and B and D where one pair alone can carry."""
    points = dict(zip("ABCDE", flanks.scene.path_of_contact, strict=True))
    single = points["A"] < points["B"] < points["D"] < points["E"]
    names = "ABCDE" if single else "ACE"
    return tuple(
        Reference(name, 1e3 * points[name], "horizontal", 0.99 if name in "ACE" else 0.95) for name in names
    )


def _strokes(flanks: LoadDistribution, chosen: IntArray, values: FloatArray, label: str) -> Strokes:
    """One stroke per slice that can touch, as long as the slice is wide and as oblique as the helix."""
    present = (flanks.on_path | (flanks.force > 0.0))[chosen]
    roll, face = 1e3 * flanks.roll_length_1[chosen], 1e3 * flanks.face_position
    rise = -0.5e3 * flanks.slice_width * math.tan(flanks.base_helix_angle) * flanks.on_path[chosen]
    half = 0.5e3 * flanks.slice_width
    x = np.stack(np.broadcast_arrays(face - half, face + half), axis=-1)
    ends = np.stack([roll - rise, roll + rise], axis=-1)[present]
    across = np.broadcast_to(x, (*present.shape, 2))[present]
    return Strokes(across, ends, values[chosen][present], label, float(values.max()))


def _strip(flanks: LoadDistribution) -> str:
    return f"One stroke is {number(1e3 * flanks.slice_width, 2)} mm of the face, its color the mean there."


def _carrying(flanks: LoadDistribution, position: int) -> int:
    return int(np.count_nonzero(flanks.force[position].sum(axis=-1)))


def _table(flanks: LoadDistribution, chosen: IntArray) -> Table:
    """Pairs in contact, line load and pressure at the positions shown."""
    rows = tuple(
        (
            f"{flanks.position[k]:.4g}",
            str(_carrying(flanks, int(k))),
            number(1e-3 * float(flanks.line_load[k].max())),
            number(float(flanks.line_load_factor[k]), 3),
            number(1e-6 * float(flanks.pressure[k].max())),
        )
        for k in chosen
    )
    head = (
        "position, base pitches",
        "pairs that carry",
        "largest line load, N/mm",
        "over its mean",
        "largest pressure, MPa",
    )
    return Table("Contact lines by position", head, rows)
