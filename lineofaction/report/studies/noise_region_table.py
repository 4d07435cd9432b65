"""Regions of housings through which the sound leaves, in tables and words."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from dynamics.noise import RadiatedSound, loudest
from lineofaction.gearbox.units import MM, RPM
from lineofaction.report.drawing.figure import Table, number

POINTS = 3
"""Loudest points whose regions are listed."""
HEAD = (
    "order",
    "speed, rpm",
    "region",
    "share, %",
    "mW/m²",
    "center, mm",
    "outward normal",
    "area, cm²",
)


def place(region: Mapping[str, Any]) -> str:
    """Name a region: its housing, the axis that it faces, the named points next to it."""
    named = f" ({', '.join(region['points'])})" if region["points"] else ""
    return f"{region['housing']} at {region['facing']}{named}"


def most(sound: RadiatedSound) -> str:
    """Say through which region most of the loudest point leaves."""
    region = sound.facts["regions"][0][0]
    return f"{100.0 * region['share']:.0f} % leaves {place(region)}"


def region_table(sound: RadiatedSound) -> Table:
    """List the regions of the loudest points."""
    rows = [
        (
            f"{point.order:.4g}",
            number(point.speed / RPM, 5),
            place(region),
            f"{100.0 * region['share']:.1f}",
            number(1e3 * region["power"] / region["area"], 3),
            ", ".join(f"{round(value / MM)}" for value in region["center"]),
            ", ".join(f"{round(value, 2) + 0.0:g}" for value in region["normal"]),
            f"{1e4 * region['area']:.1f}",
        )
        for point, regions in zip(loudest(sound, POINTS), sound.facts["regions"], strict=False)
        for region in regions
    ]
    return Table("Regions through which the loudest points radiate", HEAD, tuple(rows))
