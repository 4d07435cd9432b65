"""The 64 x 12 table of the 20/20 pair here and by full finite-element contact, in one run, in plane strain.

CalculiX runs four positions at the largest load; its time for the table is the mean of these times 768. Left
out where it is not installed.
"""

from __future__ import annotations

import sys

from benchmarks.example_pair import TORQUES
from benchmarks.figures import Figure
from fe_contact import Gear, GearPair, frontier

SUBJECT = "64 x 12 table in plane strain, here and by CalculiX"
RUNGS = ("thin_slices", "plane_strain")
POSITIONS = 4
TARGET = 100.0 / 1000.0


def figures() -> list[Figure]:
    """Return times of both, their ratio, and how far they are apart."""
    gear = Gear(teeth=20, normal_module=4e-3, face_width=25e-3, bore_diameter=40e-3)
    pair = GearPair(gear, gear, center_distance=80e-3)
    found = frontier(pair, torques=list(TORQUES), rungs=RUNGS, full_contact=POSITIONS)
    other, here = found.full_contact, found.reference.cpu_seconds
    if other is None:
        sys.stderr.write(f"full contact left out: {found.left_out['full_contact']}\n")
        return []
    there = other.seconds(found.solves)
    return [
        Figure(SUBJECT, f"CalculiX, a position at {other.torque:.4g} N m", there / found.solves, "CPU s"),
        Figure(SUBJECT, f"CalculiX, the table: from {POSITIONS} positions, extrapolated", there, "CPU s"),
        Figure(SUBJECT, "here, the table with its error estimate, nothing cached", here, "CPU s"),
        Figure(SUBJECT, "here over CalculiX", 100.0 * here / there, "%", TARGET),
        Figure(SUBJECT, "mean of these positions, apart", 100.0 * other.mean_error, "%", 0.3),
        Figure(SUBJECT, "peak-to-peak of these positions, apart", 100.0 * other.peak_to_peak_error, "%", 1.0),
    ]
