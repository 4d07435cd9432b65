"""Stress in the roots of one tooth of each gear on its way through the mesh."""

from __future__ import annotations

import math

from fe_contact.analysis import RootStress, RootStressHistory
from fe_contact.analysis.root_stress_history import RootPeak
from service.report import palette
from service.report.figure import Axis, Figure, Line, Panel, Reference, number

_MPA = 1e-6
_WAY = Axis("position of the tooth's own pair, base pitches (0 = pitch point)")
_STRESS = Axis("root stress, MPa")


def root_stress_figure(stress: RootStress) -> Figure:
    """Draw the passages of both gears: extremes of both roots, and the stress where the peaks are."""
    return Figure(
        key="root_stress",
        title="Tooth-root stress",
        caption="Solid: the largest principal stress anywhere in the root beside the loaded flank, and the "
        "smallest one in the other root. Dashed: the stress along the profile at the two places where the "
        "peaks occur; its range is what fatigue counts. The vertical line is the tension peak.",
        alternative=f"At {number(stress.torque, 4)} N m the largest stress is "
        f"{_said(stress.pinion.peak('tension'))} on the pinion and "
        f"{_said(stress.wheel.peak('tension'))} on the wheel.",
        content=(_passage("pinion", stress.pinion), _passage("wheel", stress.wheel)),
    )


def _passage(name: str, history: RootStressHistory) -> Panel:
    """Draw one gear."""
    way, peak = history.passage(), history.peak("tension")
    lines = (
        Line("tension", way.position, _MPA * way.tension, palette.VERMILLION),
        Line("at its peak", way.position, _MPA * way.at_tension_peak, palette.ORANGE, "dash"),
        Line("compression", way.position, _MPA * way.compression, palette.BLUE),
        Line("at its peak", way.position, _MPA * way.at_compression_peak, palette.SKY, "dash"),
    )
    position = peak.position % 1.0 + peak.pair
    return Panel(_WAY, _STRESS, lines, (Reference(_said(peak), position),), title=name)


def _said(peak: RootPeak) -> str:
    """Return stress and place of a peak in words."""
    value, lean = number(_MPA * peak.stress.value), math.degrees(peak.tangent_angle)
    return f"{value} MPa at the {number(lean, 2)} degree tangent"
