"""A gear with deviations, and its curve and value file as a measuring machine writes them.

The machine looks at the gear from above. Its files are written by going round that gear: material is minus on
left flanks and plus on right ones, leads go up, teeth and pitches follow the direction of counting.
"""

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

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
COUNTED = [1, *range(TEETH, 1, -1)]
"""Teeth, numbered clockwise, in the order in which one meets them counterclockwise."""
UNDEFINED = "-2147483.648"
CONVENTIONS = """
 161 :Zaehlrichtung 0-im Uhrzeigersinn     :ZRICH: {counting}
 162 :Zahnverteilung 0-DIN 1-USA           :ZVERT: 0
 163 :Zahn-/Lückenmessung 0-Zahn/-1-Luecke :ZZALU: 0
 164 :Seitendefinition: 0-VDI/DIN / 1-USA  :ZSDEF: 0
 165 :Reference fHb: 0-VDI / 1-DIN / 2- +-+ / 3- -VDI / 4- -+- :R_FHB: 1 : L: + : R: -
 178 :Vorzeichen Flankenlinie 0-VDI,1-DIN  :LVORZ: 1: DIN
 179 :Bezugslaenge Flankenlinie fHß        :BZGFL: 1: Z
 180 :Bezugslaenge Profil       fHa        :BZGPR: 0: M1-M2
 181 :Plusmaterial Fl. ;Gesamt Fß,Form ffß :PLMFL: 0: 0: 1
 182 :Plusmaterial Pr. ;Gesamt Fa,Form ffa :PLMPR: 0: 0: 1
 183 :Schnitt: 0-Stirn, 1-Normal, 2-Achs   :SCHNT: 0
 244 :Aufspannrichtung (TURN)              :ZTURN: 0"""


def diameter(roll: float) -> float:
    return 2e3 * math.hypot(roll, GEAR.base_radius)


def heading(separate: bool, counting: int = 1, file: str = "MK", part: float = 0.0) -> Iterator[str]:
    """Yield the lines of a heading; `part` of a trace at either end is not evaluated."""
    first, last = sorted((GEAR.form_roll_length, GEAR.tip_roll_length))
    shorter = part * (last - first)
    yield from (f"HEADER KS.{file}.FILE", "TYPE STI ! of machine", "UNITS mm ! Units mm or inch")
    yield from ("ANGLE decimal ! Angle", "PROFILE   diameter  ! Graph", f"UNDEFINED {UNDEFINED} ! Undefined")
    yield from ("FILTER LEAD:    F:S 2", "FILTER PROFILE: F:S 2", "")
    yield from (
        "  2 :Datum.............: 1.2.26",
        "  3 :Zeit..............: 10:15",
        "  7 :ME/Seite/KS/LZ....: a gear",
    )
    yield f" 22 :Zähnezahl z.........: {TEETH}  Außenverzahnung"
    yield " 23 :Normalmodul.....mn [mm]..:  4.000"
    for code, symbol, value in (
        (41, "Start Messbereich......da", diameter(first)),
        (42, "Start der Auswertestrecke...d1", diameter(first + shorter)),
        (43, "Ende der Auswertestrecke....d2", diameter(last - shorter)),
        (44, "Ende der Messstrecke...de", diameter(last)),
        (61, "Messanfang (unten).....ba", 0.0),
        (62, "Auswerteanfang.........b1", 25.0 * part),
        (63, "Auswerteende...........b2", 25.0 * (1.0 - part)),
        (64, "Messende (oben)........be", 25.0),
    ):
        yield f" {code} :{symbol}  [mm]..:  {value:.9f}" + (f"  {value:.9f}" if separate else "")
    yield " 80 :SECTION TOL.ASYM"
    yield from CONVENTIONS.format(counting=counting).strip("\n").splitlines()


def rows(values: list[float]) -> list[str]:
    return [" ".join(f"{value:.6f}" for value in values[k : k + 12]) for k in range(0, len(values), 12)]


def machine_text(chart: Chart, separate: bool = True, counting: int = 1, part: float = 0.0) -> str:
    """Write what `inspected` measures as a machine does, titles above their traces or beside them."""
    points = list(inspected(chart))
    lines = list(heading(separate, counting, part=part))
    side, material = SIDES[chart.loaded], {"left": -1e6, "right": 1e6}[chart.loaded]
    order = COUNTED if counting else sorted(COUNTED)
    for title, kind, place in (("Flankenlinie", "helix", "x= 8.742"), ("Profil", "profile", "z= 7.5")):
        lines += [f"{title}:"] if separate else []
        for number, tooth in enumerate(order, 1):
            values = [material * p.deviation for p in points if (p.trace, p.tooth) == (kind, tooth)]
            if values:
                upward = values[::-1] if kind == "helix" else values  # the datum face is above
                head = f"Zahn-Nr.: {number} {side} / {len(upward)}"
                lines.append(f"{head}  Werte  {place}" if separate else f"{title}:  {head} Werte / {place}")
                lines += rows(upward)
    lines += [f"        {TABLES[chart.loaded]} Zahnflanke", "        Zahn-Nr.  fp  Fp  Fr", ""]
    clockwise = {p.tooth: 1e6 * p.deviation for p in points if p.trace == "cumulative_pitch"}
    ahead = [(-1 if counting else 1) * clockwise[tooth] for tooth in order]
    steps = [value - before for value, before in zip(ahead, [ahead[-1], *ahead[:-1]], strict=True)]
    lines += [
        f"  {k}  {step:.6f}  {value:.6f}  -.3"
        for k, (step, value) in enumerate(zip(steps, ahead, strict=True), 1)
    ]
    return "\n".join(lines) + "\n"


@dataclass(frozen=True)
class Wave:
    """A trace with a slope and a wave of whole cosines over its evaluated part, which has no slope itself."""

    kind: str
    number: int
    flank: str
    slope: float
    height: float

    def material(self, points: int, part: float) -> list[float]:
        """Return material in um: the slope over the evaluated part, half the height for the amplitude."""
        u = (np.linspace(0.0, 1.0, points) - part) / (1.0 - 2.0 * part)
        return [float(v) for v in self.slope * u - 0.5 * self.height * np.cos(4.0 * math.pi * u)]


def wave_texts(waves: Iterable[Wave], part: float = 0.05, points: int = 401) -> tuple[str, str]:
    """Write curve and value file of traces with slopes and heights that are known in closed form."""
    curves, values = list(heading(True, part=part)), list(heading(True, file="MW", part=part))
    codes = {"profile": ("201", "207", "fHa", "ffa"), "helix": ("101", "107", "fHb", "ffb")}
    for wave in waves:
        side, sign = SIDES[wave.flank], {"left": -1.0, "right": 1.0}[wave.flank]
        title = {"profile": "Profil", "helix": "Flankenlinie"}[wave.kind]
        curves += [f"{title}:", f"Zahn-Nr.: {wave.number} {side} / {points}  Werte  z= 7.5"]
        curves += rows([sign * value for value in wave.material(points, part)])
        of_slope, of_form, slope, form = codes[wave.kind]
        # a lead that rises on a left flank is that of a right-hand helix; it is stated over the face width
        printed = wave.slope if wave.kind == "profile" else -sign * wave.slope / (1.0 - 2.0 * part)
        digit = "12"[wave.flank == "right"]
        values.append(f"{of_slope}{digit}1 : {slope} {side} {wave.number} : {printed:8.1f}")
        values.append(f"{of_form}{digit}1 : {form} {side} {wave.number} : {wave.height:8.1f}")
    return "\n".join(curves) + "\n", "\n".join(values) + "\n"
