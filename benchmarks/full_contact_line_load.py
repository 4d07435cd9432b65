"""Largest line load and K_Hbeta of misaligned pairs against full contact that resolves the free ends.

`python -m benchmarks.full_contact_line_load` solves the peers anew on two meshes each and prints their
largest loads: some 6 CPU minutes. Rows of the reference are the finer mesh and its difference from the other.
"""

from __future__ import annotations

import csv
import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.figures import Figure
from fe_contact import AnalysisOptions, Gear, GearPair, LoadDistribution, OperatingPoint, flank_results
from fe_contact.full_contact import (
    HelicalMesh,
    Resolution,
    solve_full_contact_helical,
    solve_full_contact_over_face,
)
from fe_contact.full_contact.table import LineLoad
from fe_contact.types import FloatArray

REFERENCE = Path(__file__).parents[1] / "tests" / "reference" / "full_contact_line_load.csv"
SUBJECT = "line load at free ends against full contact"
STRETCHES, SLICES = 90, 15
"""Over the face, of flank results in their usual slices: lengths over which a peak is taken."""
PeerMesh = Resolution | HelicalMesh
MESHES: tuple[tuple[PeerMesh, PeerMesh], ...] = (
    (Resolution(2.0, layers=11, outermost=0.05), Resolution(2.0, layers=6, outermost=0.1)),
    (HelicalMesh(0.15, 8, 11, 57), HelicalMesh(0.2, 6, 11, 57)),
)
"""Finer and coarser mesh of the peer of each case."""


@dataclass(frozen=True)
class LineLoadCase:
    """A pair at one position in base pitches and one torque in N m, at misalignments in m."""

    name: str
    pair: GearPair
    position: float
    torque: float
    misalignments: tuple[float, ...]


def line_load_cases() -> tuple[LineLoadCase, ...]:
    """Return a spur pair, one of its teeth in contact, and a helical pair, two lines in contact."""
    spur = Gear(20, 3e-3, 12e-3, 30e-3)
    angle = math.radians(18.0)
    pinion = Gear(19, 3e-3, 14e-3, 30e-3, helix_angle=angle)
    wheel = Gear(29, 3e-3, 14e-3, 40e-3, helix_angle=-angle)
    distance = pinion.reference_radius + wheel.reference_radius
    return (
        LineLoadCase("spur 20/20", GearPair(spur, spur, 60e-3), 0.05, 30.0, (0.0, 15e-6)),
        LineLoadCase("helical 19/29", GearPair(pinion, wheel, distance), 0.2, 40.0, (12e-6,)),
    )


@dataclass(frozen=True)
class ComparedPeak:
    """A largest line load in N/mm or a K_Hbeta: ours, its stated error, the peer and its error."""

    case: LineLoadCase
    misalignment: float
    quantity: str
    length: float
    value: float
    stated: float
    peer: float
    peer_error: float

    @property
    def difference(self) -> float:
        """Ours over the peer, less one."""
        return self.value / self.peer - 1.0

    @property
    def covered(self) -> bool:
        """Whether the stated error and that of the peer reach the difference."""
        return abs(self.value - self.peer) <= self.stated + self.peer_error


def compared(case: LineLoadCase, level: str) -> Iterator[ComparedPeak]:
    """Yield the peaks of flank results of a level against the recorded ones of the peer."""
    with REFERENCE.open(encoding="utf-8", newline="") as file:
        rows = [row for row in csv.DictReader(file) if row["case"] == case.name]
    options = AnalysisOptions(level=level, model="3d")
    for misalignment in case.misalignments:
        point = OperatingPoint(torque=case.torque, misalignment=misalignment)
        flanks = flank_results(case.pair, point, options, at=[case.position])
        load, factor = flanks.largest_line_load, flanks.largest_face_load_factor
        relative = {"line_load_n_per_mm": load.error / load.value, "k_h_beta": factor.error / factor.value}
        for row in rows:
            if float(row["misalignment_um"]) == round(1e6 * misalignment, 6):
                length, quantity = 1e-3 * float(row["length_mm"]), row["quantity"]
                value = _peak(flanks, quantity, length)
                peer = float(row["value"]), float(row["error"])
                stated = relative[quantity] * value
                yield ComparedPeak(case, misalignment, quantity, length, value, stated, *peer)


def _peak(flanks: LoadDistribution, quantity: str, length: float) -> float:
    """Return the largest mean over a length of the face: of lines clear of edges, or of the face load."""
    stretches = max(round(length / flanks.slice_width), 1)
    if quantity == "k_h_beta":
        return float(_means(flanks.face_load, stretches).max() / flanks.face_load.mean())
    clear = np.where(flanks.at_edge, 0.0, flanks.line_load)
    return 1e-3 * float(_means(clear, stretches).max())


def _means(load: FloatArray, stretches: int) -> FloatArray:
    """Return the means of loads (..., K) over so many stretches beside each other."""
    windows = np.lib.stride_tricks.sliding_window_view(load, stretches, axis=-1)
    return np.asarray(windows.mean(axis=-1))


def figures() -> list[Figure]:
    """Return the differences at the level "standard"."""
    return [
        Figure(
            SUBJECT,
            f"{peak.case.name}, {1e6 * peak.misalignment:g} um: {peak.quantity} over "
            f"{1e3 * peak.length:.2g} mm",
            100.0 * abs(peak.difference),
            "%",
            2.0,
        )
        for case in line_load_cases()
        for peak in compared(case, "standard")
    ]


def peer_loads(case: LineLoadCase, mesh: PeerMesh) -> Iterator[tuple[float, tuple[LineLoad, ...]]]:
    """Yield the line loads of the peer at each misalignment, m."""
    at = [case.torque], [case.position], case.misalignments
    tables = (
        solve_full_contact_helical(case.pair, *at, mesh)
        if isinstance(mesh, HelicalMesh)
        else solve_full_contact_over_face(case.pair, *at, mesh)
    )
    for misalignment, table in zip(case.misalignments, tables, strict=True):
        yield misalignment, table.points[0][0].line_loads


def face_load_factor(loads: tuple[LineLoad, ...], face_width: float, length: float) -> float:
    """Return the largest mean of the load of all pairs over a length of the face, over its mean."""
    face = np.linspace(-0.5, 0.5, 4001) * face_width
    total = sum(np.interp(face, own.face_position, own.load, left=0.0, right=0.0) for own in loads)
    whole = LineLoad(0, face, np.asarray(total))
    return whole.largest_mean(length) / float(np.mean(total))


def publish() -> None:
    """Print the peaks of both meshes of each peer."""
    for case, meshes in zip(line_load_cases(), MESHES, strict=True):
        for mesh in meshes:
            for misalignment, loads in peer_loads(case, mesh):
                (own,) = (load for load in loads if load.ahead == 0)
                for part in (SLICES, STRETCHES):
                    length = case.pair.face_width / part
                    factor = face_load_factor(loads, case.pair.face_width, length)
                    print(case.name, mesh, misalignment, length, own.largest_mean(length), factor)


if __name__ == "__main__":
    publish()
