"""The 64 x 12 table of the 20/20 pair here and by full finite-element contact, in one run, in plane strain.

The condensed peer runs four positions under all loads, CalculiX the same at the largest load, on the same
meshes. Times for the table are extrapolated: a position times 64, a position and load times 768. CalculiX
is left out where it is not installed.
"""

from __future__ import annotations

import sys
from pathlib import Path

from benchmarks.example_pair import TORQUES
from benchmarks.figures import Figure
from fe_contact import Gear, GearPair, frontier
from fe_contact.analysis.studies.frontier import Frontier
from fe_contact.analysis.studies.full_contact_record import FullContactComparison
from fe_contact.options import AnalysisOptions, TableAxes
from model_studies.progress import unreported
from model_studies.stage_clock import StageClock
from verification.full_contact_record import record_full_contact

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "fakes"))
from calculix import find_calculix, solve_position

SUBJECT = "64 x 12 table in plane strain, here and by full contact"
FIDELITIES = ("thin_slices", "plane_strain")
POSITIONS = 4
TARGET = 100.0 / 1000.0
CPU_LIMIT = 900.0


def figures() -> list[Figure]:
    """Return times of all three, their ratios, and how far they are apart."""
    gear = Gear(teeth=20, normal_module=4e-3, face_width=25e-3, bore_diameter=40e-3)
    pair = GearPair(gear, gear, center_distance=80e-3)
    checked = Frontier.request(pair, TableAxes(torques=list(TORQUES)), AnalysisOptions())
    records = [record_full_contact(checked, POSITIONS, unreported)]
    found = frontier(checked, fidelities=FIDELITIES, full_contact=POSITIONS, records=records)
    other, own_seconds = found.full_contact, found.reference.cpu_seconds
    assert other is not None
    other_seconds = other.seconds(found.solves)
    return [
        Figure(
            SUBJECT,
            "condensed peer, a position, all loads, with its error",
            other_seconds / 64.0,
            "CPU s",
            5.0,
        ),
        Figure(SUBJECT, f"condensed peer, the table: from {POSITIONS} positions", other_seconds, "CPU s"),
        Figure(SUBJECT, "here, the table with its error estimate, nothing cached", own_seconds, "CPU s"),
        Figure(SUBJECT, "mean of these positions, apart", 100.0 * other.mean_error, "%", 0.3),
        Figure(SUBJECT, "peak-to-peak of these positions, apart", 100.0 * other.peak_to_peak_error, "%", 1.0),
        *_calculix(pair, other, found.solves, own_seconds),
    ]


def _calculix(pair: GearPair, peer: FullContactComparison, solves: int, here: float) -> list[Figure]:
    """Return the time of CalculiX, and how far the condensed peer is from it."""
    program = find_calculix()
    if program is None:
        sys.stderr.write("CalculiX left out: it is not installed\n")
        return []
    clock, force = StageClock(), float(pair.normal_force(max(TORQUES)))
    with clock.stage("CalculiX"):
        points = [solve_position(program, pair, force, n / POSITIONS, CPU_LIMIT) for n in range(POSITIONS)]
    each = clock.seconds["CalculiX"] / POSITIONS
    mean = sum(point.transmission_error for point in points) / POSITIONS
    apart = abs(float(peer.record.transmission_error[0, :, -1].mean()) / mean - 1.0)
    return [
        Figure(SUBJECT, f"CalculiX, a position at {max(TORQUES):.4g} N m", each, "CPU s"),
        Figure(SUBJECT, "here over CalculiX", 100.0 * here / (each * solves), "%", TARGET),
        Figure(SUBJECT, "condensed peer and CalculiX, mean, apart", 100.0 * apart, "%", 0.1),
    ]
