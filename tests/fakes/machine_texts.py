"""A gear with deviations, and its curve file as a measuring machine writes it (P40)."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from fe_contact.geometry import Gear, PitchDeviation, ToothFlank
from lineofaction.gearbox.inspection.measured_gear import Chart, inspected

TEETH = 20
PITCHES = PitchDeviation(tuple(1e-6 * np.random.default_rng(5).normal(0.0, 4.0, TEETH)))
FLANKS = (ToothFlank(3, 4e-6, -2e-6, 2, -3e-6), ToothFlank(20, -1e-6, helix_form=3e-6))
GEAR = Gear(TEETH, 4e-3, 25e-3, 40e-3, pitch_deviation=PITCHES, tooth_flanks=FLANKS)
CHART = Chart(GEAR, "right", True)
SIDES = {"left": "links", "right": "rechts"}
TABLES = {"left": "linke", "right": "rechte"}


def diameter(roll: float) -> float:
    return 2e3 * math.hypot(roll, GEAR.base_radius)


def heading(separate: bool) -> Iterator[str]:
    ends = sorted((GEAR.form_roll_length, GEAR.tip_roll_length))
    yield from ("HEADER KS.MK.FILE", "TYPE STI ! of machine", "UNDEFINED -2147483.648 ! Undefined", "")
    yield "  7 :ME/Seite/KS/LZ....: a gear"
    yield f" 22 :Zähnezahl z.........: {TEETH}  Außenverzahnung"
    yield " 23 :Normalmodul.....mn [mm]..:  4.000"
    for code, symbol, value in (
        (41, "Start Messbereich......da", diameter(ends[0])),
        (44, "Ende der Messstrecke...de", diameter(ends[1])),
        (51, "Messanfang.............ba", 0.0),
        (54, "Messende...............be", 25.0),
    ):
        yield f" {code} :{symbol}  [mm]..:  {value:.9f}" + (f"  {value:.9f}" if separate else "")


def rows(values: list[float]) -> list[str]:
    return [" ".join(f"{value:.6f}" for value in values[k : k + 12]) for k in range(0, len(values), 12)]


def machine_text(chart: Chart, separate: bool = True) -> str:
    """Write what `inspected` measures as a machine does, titles above their traces or beside them."""
    points = list(inspected(chart))
    lines = list(heading(separate))
    side = SIDES[chart.loaded]
    for title, kind, place in (("Flankenlinie", "helix", "x= 8.742"), ("Profil", "profile", "z= 7.5")):
        lines += [f"{title}:"] if separate else []
        for tooth in sorted({point.tooth for point in points if point.trace == kind}):
            values = [1e6 * p.deviation for p in points if (p.trace, p.tooth) == (kind, tooth)]
            head = f"Zahn-Nr.: {tooth} {side} / {len(values)}"
            lines.append(f"{head}  Werte  {place}" if separate else f"{title}:  {head} Werte / {place}")
            lines += rows(values)
    lines += [f"        {TABLES[chart.loaded]} Zahnflanke", "        Zahn-Nr.  fp  Fp  Fr", ""]
    pitches = [p for p in points if p.trace == "cumulative_pitch"]
    lines += [f"  {p.tooth}  0.1  {1e6 * p.deviation:.6f}  -.3" for p in pitches]
    return "\n".join(lines) + "\n"
