"""Predicted against measured CPU time of runs in the plane and over the face, usual and unusual ones."""

from __future__ import annotations

from statistics import median
from typing import Any

from benchmarks.figures import Figure
from benchmarks.fresh_process import measure

_CODE = """
import math, tempfile
from dataclasses import replace
from pathlib import Path
from fe_contact import Gear, GearPair, InternalGearPair, RingGear, analyze
from fe_contact.geometry import BoreSeat, GearBlank, PitchDeviation
from fe_contact.analysis.studies.frontier import warm_up

def pair(first, second, module, modules, helix=0.0, bore=0.5):
    def gear(teeth, angle):
        return Gear(teeth=teeth, normal_module=module, face_width=modules * module,
                    bore_diameter=bore * teeth * module, helix_angle=angle)
    distance = 0.5 * (first + second) * module / math.cos(helix)
    return GearPair(gear(first, helix), gear(second, -helix), distance)

def ring(teeth, ring_teeth, module, modules):
    wheel = RingGear(ring_teeth, module, modules * module,
                     rim_diameter=(ring_teeth + 12) * module, tip_diameter=(ring_teeth - 1.5) * module)
    pinion = pair(teeth, 30, module, modules).pinion
    return InternalGearPair(pinion, wheel, 0.5 * (ring_teeth - teeth) * module)

plane = [
    (18, 25, 2e-3, 5.0, 0.5), (20, 33, 4e-3, 8.0, 0.5), (22, 47, 3e-3, 10.0, 0.6),
    (25, 25, 2e-3, 6.0, 0.4), (27, 90, 2e-3, 12.0, 0.5), (31, 62, 1e-3, 10.0, 0.7),
    (35, 36, 5e-3, 6.0, 0.5), (40, 110, 2e-3, 10.0, 0.6),
]
wishes = [("auto", "draft", None, 1), ("plane_strain", "standard", 64, 5), ("auto", "standard", None, 3),
          ("plane_strain", "draft", None, 2)]
def run(kind, gears, model, level, positions, loads, again=False, **more):
    return kind, gears, dict(model=model, level=level, positions=positions, **more), loads, again
cases = [run("2-D", pair(*sizes[:4], bore=sizes[4]), *wishes[(i + j) % 4])
         for i, sizes in enumerate(plane) for j in range(2)]
face = [
    (19, 24, 2e-3, 4.0, 0.0), (21, 28, 3e-3, 6.0, 0.0), (23, 40, 2e-3, 4.0, 0.0), (26, 26, 2e-3, 8.0, 0.0),
    (20, 29, 2e-3, 4.0, 0.3), (24, 24, 3e-3, 6.0, 0.2), (28, 35, 2e-3, 4.0, 0.4), (32, 33, 2e-3, 6.0, 0.15),
]
for i, sizes in enumerate(face):
    cases.append(run("3-D", pair(*sizes), "3d", "draft", (None, 32)[i % 2], 1 + i % 3))
cases += [run("3-D", pair(*sizes), "3d", "standard", 32, 2) for sizes in face[:2] + face[4:6]]
# runs of other kinds
cases += [run("minimal", pair(*sizes[:4]), "auto", "draft", at, 3, receipt="minimal")
          for sizes, at in zip(plane[:4], (64, None) * 2)]
cases += [run("minimal", pair(*sizes), "3d", "draft", 32, 2, receipt="minimal") for sizes in face[4:6]]
cases += [run("cached", pair(*sizes[:4]), "auto", "standard", at, 6, again=True)
          for sizes, at in zip(plane[:4], (64, None) * 2)]
cases += [run("cached", pair(*sizes), "3d", "draft", at, 4, again=True)
          for sizes, at in zip(face[3:7], (64, None) * 2)]
cases += [run("internal", ring(*sizes), model, "draft", None, 2)
          for sizes, model in (((20, 60, 2e-3, 6.0), "auto"), ((24, 75, 3e-3, 8.0), "auto"),
                               ((20, 66, 2e-3, 5.0), "3d"), ((25, 80, 2e-3, 4.0), "3d"))]
def with_wheel(gears, **more):
    return replace(gears, wheel=replace(gears.wheel, **more))
for sizes in face[:2] + face[4:6]:
    gears = pair(*sizes)
    m = gears.wheel.normal_module
    blank = GearBlank(2.0 * m, 0.4 * gears.wheel.face_width, 0.7 * gears.wheel.teeth * m)
    cases.append(run("thin rim", with_wheel(gears, blank=blank), "auto", "draft", 32, 2))
    seat = BoreSeat(radial_foundation=5e13, tangential_foundation=5e13, axial_foundation=5e13)
    cases.append(run("seat", with_wheel(gears, seat=seat), "auto", "draft", 32, 2))
for sizes in plane[:4]:
    gears = pair(*sizes[:4])
    runout = PitchDeviation(tuple(5e-6 * math.sin(2 * math.pi * k / gears.pinion.teeth)
                                  for k in range(gears.pinion.teeth)))
    pinion = replace(gears.pinion, pitch_deviation=runout)
    cases.append(run("long period", replace(gears, pinion=pinion), "plane_strain", "draft", 32, 2))
warm_up(across_face=True)
# by turns, as a user's runs come; every gear is computed once, so that nothing is in the cache
order = sorted(range(len(cases)), key=lambda i: (7 * i) % len(cases))
found = []
with tempfile.TemporaryDirectory() as folder:
    for i in order:
        kind, gears, how, loads, again = cases[i]
        rated = 60.0 * gears.face_width * gears.pinion.normal_module * 1e6
        forces = [rated * (k + 1) / loads for k in range(loads)]
        for _ in range(1 + again):
            receipt = analyze(gears, normal_forces=forces, cache=Path(folder), **how).metadata.receipt
        stages = receipt["prediction"]["stages"]
        measured = sum(receipt["stages"][name]["cpu_seconds"] for name in stages if name in receipt["stages"])
        found.append([kind, receipt["prediction"]["cpu_seconds"], measured])
        for file in Path(folder).glob("compliance-*"):
            file.unlink()
measured = {"found": found}
"""
_LEARNT = 4
"""Runs after which the log is taken to know the host."""


def figures() -> list[Figure]:
    """Return how far predictions are off, all together and by kind of run."""
    found: list[Any] = measure(_CODE)["found"]
    kinds = dict.fromkeys(kind for kind, _, _ in found)
    subject = f"predicted CPU time, {len(found)} runs"
    ratios = [_factor(one) for one in found]
    beyond = [100.0 * sum(r > 1.5 for r in part) / len(part) for part in (ratios, ratios[_LEARNT:])]
    rows = [
        Figure(subject, "off by more than a factor 1.5", beyond[0], "% of runs", 20.0),
        Figure(subject, f"the same after the first {_LEARNT} runs", beyond[1], "% of runs", 20.0),
        Figure(subject, "worst factor", max(ratios), "x", 3.0),
        Figure(subject, "median of predicted over measured", median(p / s for _, p, s in found), "x"),
    ]
    for kind in kinds:
        part = [_factor(one) for one in found if one[0] == kind]
        rows.append(Figure(subject, f"median factor, {kind} ({len(part)} runs)", median(part), "x"))
        rows.append(Figure(subject, f"worst factor, {kind}", max(part), "x", 3.0))
    return rows


def _factor(one: Any) -> float:
    """Return the factor between prediction and measurement, >= 1."""
    _, predicted, spent = one
    return float(max(predicted / spent, spent / predicted))
