"""Distribution of the load along the face: load and gap over it, centroid and K_Hbeta over position."""

from __future__ import annotations

import numpy as np

from fe_contact.analysis import LoadDistribution
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import Axis, Figure, FloatArray, Line, Panel, Reference, Table, number
from lineofaction.report.tables.aligned import POSITION_LABEL
from lineofaction.report.tables.unrolled import face_axis

SHOWN = 4  # positions

_VISIBLE_GAP = 0.01
"""um; a plot of less shows nothing."""
_ROUNDING = 1e-9
"""Part of the face width; a centroid nearer to mid-face is the rounding of a symmetric load."""


def line_load_figure(flanks: LoadDistribution) -> Figure:
    """Draw the load of all pairs per unit of face width, and the gap that the most loaded pair leaves."""
    chosen = np.unique(np.linspace(0, flanks.position.size, SHOWN, endpoint=False).astype(int))
    face = face_axis(flanks)
    mean = 1e-3 * flanks.face_load.mean(axis=0)
    names = [f"position {flanks.position[k]:.3g}" for k in chosen]
    x = 1e3 * flanks.face_position
    colors = [palette.BLUE, palette.SKY, palette.GREEN, palette.PURPLE][: len(chosen)]
    loads = [
        Line(name, x, 1e-3 * flanks.face_load[k], color, label=name)
        for name, k, color in zip(names, chosen, colors, strict=True)
    ]
    cycle = Line("mean over the positions", x, mean, palette.VERMILLION, width=3.0, label="mean")
    factor = flanks.mean_face_load_factor
    gaps = _gap_panel(flanks, face, dict(zip(names, chosen, strict=True)), colors)
    return Figure(
        key="line_load",
        title="Load and gap over the face" if gaps else "Load over the face",
        caption=_line_load_caption(flanks, with_gap=bool(gaps)),
        alternative=f"Averaged over the positions the face carries {number(float(mean.min()), 4)} to "
        f"{number(float(mean.max()), 4)} N/mm: K_Hbeta {number(factor, 3)}.",
        content=(
            Panel(face, Axis("load per face width, N/mm"), (*loads, cycle)),
            *gaps,
        ),
        table=_table(flanks, mean),
    )


def _gap_panel(
    flanks: LoadDistribution, face: Axis, chosen: dict[str, int], colors: list[str]
) -> tuple[Panel, ...]:
    """Draw the gap left on the pair that carries most; nothing where its flanks touch all along the face."""
    gaps = {name: _gap(flanks, int(k)) for name, k in chosen.items()}
    if not any(np.nanmax(gap, initial=0.0) > _VISIBLE_GAP for gap in gaps.values()):
        return ()
    x = 1e3 * flanks.face_position
    lines = tuple(
        Line(name, x, gap, color, label=name) for (name, gap), color in zip(gaps.items(), colors, strict=True)
    )
    return (Panel(face, Axis("gap, µm"), lines),)


def _line_load_caption(flanks: LoadDistribution, *, with_gap: bool) -> str:
    """Say what the panels of the load over the face show of this pair."""
    caption = "Force of all pairs per unit of face width."
    if with_gap:
        caption = (
            f"Above: {caption[0].lower()}{caption[1:]} Below: remaining gap between the loaded flanks of the "
            "pair with the largest load; 0 in contact."
        )
    else:
        caption += " The flanks of the pair with the largest load touch wherever they can: no gap."
    if flanks.base_helix_angle == 0.0:
        return caption
    return f"{caption} A single position is uneven: the number of pairs that touch changes along the face."


def load_centroid_figure(flanks: LoadDistribution) -> Figure:
    """Draw where along the face the load acts, and how unevenly it lies, over position."""
    factor = flanks.mean_face_load_factor
    rounding = _ROUNDING * float(np.ptp(flanks.face_position))
    centroid = 1e3 * np.where(np.abs(flanks.load_centroid) > rounding, flanks.load_centroid, 0.0)
    return Figure(
        key="load_centroid",
        title="Load centroid and face load factor",
        caption="Above: distance of the load's centroid from the pinion's mid-face. Below: largest over mean "
        "load per unit of face width at each position; the line is that of the load averaged over all of "
        "them, K_Hbeta of ISO 6336-1 for this alignment and without manufacturing errors.",
        alternative=f"The centroid lies {number(float(centroid.min()), 3)} to "
        f"{number(float(centroid.max()), 3)} mm from mid-face; K_Hbeta is {number(factor, 3)}.",
        content=(
            _over_position(
                flanks, Axis("load centroid, mm"), centroid, Reference("mid-face", 0.0, "horizontal")
            ),
            _over_position(
                flanks,
                Axis("largest over mean load"),
                flanks.face_load_factor,
                Reference(f"K_Hbeta {number(factor, 3)}", factor, "horizontal"),
            ),
        ),
    )


def _over_position(flanks: LoadDistribution, y: Axis, values: FloatArray, mark: Reference) -> Panel:
    """Draw a curve over one cycle, closed where the positions make one."""
    step = np.diff(flanks.position)
    whole = step.size > 0 and np.allclose(step, 1.0 / flanks.position.size)
    position = np.append(flanks.position, 1.0 + flanks.position[0]) if whole else flanks.position
    line = Line("", position, np.append(values, values[0]) if whole else values, palette.BLUE)
    x = Axis(POSITION_LABEL, limits=(float(position[0]), float(position[-1]))) if step.size else None
    return Panel(x or Axis(POSITION_LABEL), y, (line,), (mark,))


def _gap(flanks: LoadDistribution, position: int) -> FloatArray:
    """Gap in um of the pair that carries most; NaN where the flanks cannot meet."""
    pair = int(flanks.force[position].sum(axis=-1).argmax())
    gap = 1e6 * flanks.gap[position, pair]
    return np.where(np.isfinite(gap) & flanks.on_path[position, pair], gap, np.nan)


def _table(flanks: LoadDistribution, mean: FloatArray) -> Table:
    """Tabulate the averaged load and the largest line load over the face."""
    largest = 1e-3 * flanks.line_load.max(axis=(0, 1))
    rows = tuple(
        (number(1e3 * float(x), 4), number(float(m)), number(float(v)))
        for x, m, v in zip(flanks.face_position, mean, largest, strict=True)
    )
    head = ("face position, mm", "mean load per face width, N/mm", "largest line load, N/mm")
    return Table("Load over the face", head, rows)
