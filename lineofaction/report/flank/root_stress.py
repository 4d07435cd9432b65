"""Page of tooth-root stress: the stress in the roots of one tooth of each gear through the mesh."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from bounds.error_digits import error_text, to_error, with_error
from bounds.types import Json
from lineofaction.gearbox.convert.effects import assumption_lines
from lineofaction.gearbox.convert.operating_point import pair_point, typed
from lineofaction.gearbox.studies.root_stress.run import GEARS, RUN, Roots
from lineofaction.gearbox.units import UM
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import Axis, Figure, Line, Panel, Reference, Table, number
from lineofaction.report.drawing.page import Headline, Page, Part, Section
from lineofaction.report.drawing.tables import settings_table
from lineofaction.report.presentation import Presentation

_POSITION = Axis("position of the tooth's own pair, base pitches (0 = pitch point)")
_STRESS = Axis("root stress, MPa")
_SERIES = ("tension_mpa", "compression_mpa", "at_tension_peak_mpa", "at_compression_peak_mpa")
"""Stresses of a passage: the extremes anywhere in either root, and the stress at the places of both peaks."""
_LABEL = 0.2
"""Place of the label of the nominal stress along its line, 0 to 1 from the left."""


def _root_stress_figure(stresses: Json) -> Figure:
    """Draw the passages of both gears: extremes of both roots, and the stress where the peaks are."""
    return Figure(
        key="root_stress",
        title="Tooth-root stress",
        caption="Solid: the largest principal stress anywhere in the root beside the loaded flank, and the "
        "smallest one in the other root. Dashed: the stress along the profile at the two places where the "
        "peaks occur; its range is what fatigue counts. The vertical line is the tension peak; "
        "a horizontal one, of spur pairs, the nominal stress of ISO 6336-3 (method B, without load factors).",
        alternative=f"At {number(stresses['torque_n_m'], 4)} N m the largest stress is "
        f"{_said(stresses['pinion']['tension'])} on the pinion and "
        f"{_said(stresses['wheel']['tension'])} on the wheel.",
        content=tuple(_passage(gear, stresses[gear]) for gear in GEARS),
    )


def _passage(gear: str, history: Json) -> Panel:
    """Draw the stresses in both roots of a tooth while it passes through the mesh."""
    series = {name: np.array(values) for name, values in history["passage"].items()}
    position, peak = series["position"], history["tension"]
    lines = (
        Line("tension", position, series["tension_mpa"], palette.VERMILLION),
        Line("at its peak", position, series["at_tension_peak_mpa"], palette.ORANGE, "dash"),
        Line("compression", position, series["compression_mpa"], palette.BLUE),
        Line("at its peak", position, series["at_compression_peak_mpa"], palette.SKY, "dash"),
    )
    references = [Reference("", peak["position"])]  # its label would lie on the peak: the caption has it
    nominal = history["iso_6336_3_mpa"]
    if nominal is not None:
        references.append(Reference(f"ISO 6336-3: {number(nominal)} MPa", nominal, "horizontal", at=_LABEL))
    return Panel(_POSITION, _STRESS, lines, tuple(references), title=gear)


def _said(peak: Json) -> str:
    return f"{number(peak['stress_mpa'])} MPa at the {number(peak['tangent_angle_deg'], 2)} degree tangent"


def _peak_table(stresses: Json) -> Table:
    """Return the stress of every root with its error, and where it is."""
    peaks = []
    for gear in GEARS:
        for root in ("tension", "compression"):
            peaks.append({"gear": gear, "root": root, **stresses[gear][root]})
    columns = {
        "gear": lambda peak: peak["gear"],
        "root": lambda peak: peak["root"],
        "stress MPa": lambda peak: with_error(peak["stress_mpa"], peak["error_mpa"]),
        "position": lambda peak: f"{peak['position']:.3f}",
        "tangent °": lambda peak: f"{peak['tangent_angle_deg']:.1f}",
        "face mm": lambda peak: f"{peak['face_position_mm']:.2f}",
    }
    return Table.of("Tooth-root stress", peaks, columns)


def _passage_table(stresses: Json) -> Table:
    rows = []
    for gear in GEARS:
        passage = stresses[gear]["passage"]
        columns = (passage[name] for name in _SERIES)
        for position, *values in zip(passage["position"], *columns, strict=True):
            # all digits of a position: it is the key of a row
            rows.append((gear, repr(position), *(f"{value:.6g}" for value in values)))
    return Table("Passage of one tooth", ("gear", "position", *_SERIES), tuple(rows))


def _page(stresses: Json) -> Page:
    heads = tuple(_headline(stresses, gear) for gear in GEARS)
    cost = {name: value for name, value in stresses["receipt"].items() if name != "plan"}
    sections = (
        Section("Tooth roots", "", (_root_stress_figure(stresses),), (_peak_table(stresses),)),
        Section("Receipt of the root stress", tables=(settings_table("Cost", cost),), part=Part.RECEIPT),
    )
    return Page("Tooth-root stress", "", heads, sections)


def _headline(stresses: Json, gear: str) -> Headline:
    peak = stresses[gear]["tension"]
    value, error = peak["stress_mpa"], peak["error_mpa"]
    name = f"largest root stress, {gear} at {typed(stresses['torque_n_m'])} N m"
    return Headline(name, f"{to_error(value, error)} MPa", f"± {error_text(value, error)} MPa")


def _point(stresses: Json) -> str:
    return pair_point(stresses["torque_n_m"], stresses["normal_force_n"], stresses["misalignment_um"] * UM)


def _text(stresses: Json) -> Iterator[Table | str]:
    yield _peak_table(stresses)
    yield from assumption_lines(stresses["receipt"])


def _of_figures(render: Callable[[Json], Any]) -> Callable[[Roots], Any]:
    return lambda roots: render(RUN.figures(roots))


PAGE = Presentation(
    _of_figures(_root_stress_figure),
    _of_figures(_page),
    _of_figures(_text),
    series=_of_figures(_passage_table),
    point=_of_figures(_point),
)
