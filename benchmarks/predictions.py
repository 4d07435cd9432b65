"""Predicted against measured CPU time of 28 different runs, in the plane and over the face."""

from __future__ import annotations

from statistics import median

from benchmarks.figures import Figure
from benchmarks.fresh_process import measure

_CODE = """
import math, tempfile
from pathlib import Path
from fe_contact import Gear, GearPair, analyze
from fe_contact.analysis.warm_up import warm_up

def pair(first, second, module, modules, helix=0.0, bore=0.5):
    def gear(teeth, angle):
        return Gear(teeth=teeth, normal_module=module, face_width=modules * module,
                    bore_diameter=bore * teeth * module, helix_angle=angle)
    distance = 0.5 * (first + second) * module / math.cos(helix)
    return GearPair(gear(first, helix), gear(second, -helix), distance)

plane = [
    (18, 25, 2e-3, 5.0, 0.5), (20, 33, 4e-3, 8.0, 0.5), (22, 47, 3e-3, 10.0, 0.6),
    (25, 25, 2e-3, 6.0, 0.4), (27, 90, 2e-3, 12.0, 0.5), (31, 62, 1e-3, 10.0, 0.7),
    (35, 36, 5e-3, 6.0, 0.5), (40, 110, 2e-3, 10.0, 0.6),
]
wishes = [("auto", "draft", None, 1), ("plane_strain", "standard", 64, 5), ("auto", "standard", None, 3),
          ("plane_strain", "draft", None, 2)]
cases = [(pair(*sizes[:4], bore=sizes[4]), *wishes[(i + j) % 4])
         for i, sizes in enumerate(plane) for j in range(2)]
face = [
    (19, 24, 2e-3, 4.0, 0.0), (21, 28, 3e-3, 6.0, 0.0), (23, 40, 2e-3, 4.0, 0.0), (26, 26, 2e-3, 8.0, 0.0),
    (20, 29, 2e-3, 4.0, 0.3), (24, 24, 3e-3, 6.0, 0.2), (28, 35, 2e-3, 4.0, 0.4), (32, 33, 2e-3, 6.0, 0.15),
]
for i, sizes in enumerate(face):
    cases.append((pair(*sizes), "3d", "draft", (None, 32)[i % 2], 1 + i % 3))
cases += [(pair(*sizes), "3d", "standard", 32, 2) for sizes in face[:2] + face[4:6]]
warm_up(across_face=True)
# by turns, as a user's runs come; every gear is computed once, so that nothing is in the cache
order = sorted(range(len(cases)), key=lambda i: (7 * i) % len(cases))
found = []
with tempfile.TemporaryDirectory() as folder:
    for i in order:
        gears, model, level, positions, loads = cases[i]
        rated = 60.0 * gears.face_width * gears.pinion.normal_module * 1e6
        forces = [rated * (k + 1) / loads for k in range(loads)]
        receipt = analyze(gears, normal_forces=forces, model=model, level=level, positions=positions,
                          cache=Path(folder)).metadata.receipt
        stages = receipt["prediction"]["stages"]
        measured = sum(receipt["stages"][name]["cpu_seconds"] for name in stages)
        found.append([receipt["prediction"]["cpu_seconds"], measured, model == "3d"])
        for file in Path(folder).glob("compliance-*"):
            file.unlink()
measured = {"found": found}
"""
_LEARNT = 4
"""Runs after which the log is taken to know the host."""


def figures() -> list[Figure]:
    """Return how far predictions are off."""
    found = measure(_CODE)["found"]
    ratios = [max(predicted / spent, spent / predicted) for predicted, spent, _ in found]
    beyond = [100.0 * sum(r > 1.5 for r in part) / len(part) for part in (ratios, ratios[_LEARNT:])]
    signed = [predicted / spent for predicted, spent, _ in found]
    subject = f"predicted CPU time, {len(found)} runs, 2-D and 3-D, no compliance cached"
    return [
        Figure(subject, "off by more than a factor 1.5", beyond[0], "% of runs", 20.0),
        Figure(subject, f"the same after the first {_LEARNT} runs", beyond[1], "% of runs", 20.0),
        Figure(subject, "worst factor", max(ratios), "x", 3.0),
        Figure(subject, "median of predicted over measured", median(signed), "x"),
        Figure(
            subject,
            "median factor, 2-D",
            median(r for r, f in zip(ratios, found, strict=True) if not f[2]),
            "x",
        ),
        Figure(
            subject, "median factor, 3-D", median(r for r, f in zip(ratios, found, strict=True) if f[2]), "x"
        ),
    ]
