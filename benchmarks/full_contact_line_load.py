"""Largest line load and K_Hbeta of misaligned pairs against full contact that resolves the free ends.

`python -m benchmarks.full_contact_line_load` solves the peers anew and prints their largest loads, some 90
CPU s a mesh. Of the first pair of each kind rows of the reference are the finer mesh and its difference from
another one; the others have one mesh and the relative difference of that pair.
"""

from __future__ import annotations

import csv
import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.figures import Figure
from fe_contact import (
    AnalysisOptions,
    FlankModification,
    Gear,
    GearPair,
    LoadDistribution,
    OperatingPoint,
    flank_results,
)
from fe_contact.types import FloatArray
from verification.full_contact import (
    HelicalMesh,
    Resolution,
    solve_full_contact_helical,
    solve_full_contact_over_face,
)
from verification.full_contact.line_load import LineLoad

REFERENCE = Path(__file__).parents[1] / "tests" / "reference" / "full_contact_line_load.csv"
SUBJECT = "line load at free ends against full contact"
PLAIN = FlankModification()
STRETCHES, SLICES = 90, 15
"""Number of stretches and slices of flank results over the face: the lengths over which a peak is taken."""
PeerMesh = Resolution | HelicalMesh
SPUR_MESH, HELICAL_MESH = Resolution(2.0, layers=11, outermost=0.05), HelicalMesh(0.15, 8, 15, 57)


@dataclass(frozen=True)
class LineLoadCase:
    """A pair at one position in base pitches and one torque in N m, at misalignments in m."""

    name: str
    pair: GearPair
    position: float
    torque: float
    misalignments: tuple[float, ...]
    meshes: tuple[PeerMesh, ...]
    """Meshes of the peer, the finest first."""
    edge: int | None = None
    """Pair index of the peer's line that ends at a tip edge."""


def line_load_cases() -> tuple[LineLoadCase, ...]:
    """Return spur and helical pairs; the first of either kind set the stated error, the others not."""
    return (*_pairs_on_two_meshes(), *_fresh_spur_pairs(), *_fresh_helical_pairs())


def _pairs_on_two_meshes() -> tuple[LineLoadCase, ...]:
    spur = Gear(20, 3e-3, 12e-3, 30e-3)
    return (
        LineLoadCase(
            "spur 20/20",
            GearPair(spur, spur, 60e-3),
            0.05,
            30.0,
            (0.0, 15e-6),
            (SPUR_MESH, Resolution(2.0, layers=6, outermost=0.1)),
        ),
        LineLoadCase(
            "helical 19/29",
            _helical(19, 29, 18.0, 3e-3, 14e-3),
            0.2,
            40.0,
            (12e-6,),
            (HelicalMesh(0.15, 8, 11, 57), HelicalMesh(0.2, 6, 11, 57)),
        ),
    )


def _fresh_spur_pairs() -> tuple[LineLoadCase, ...]:
    pinion = Gear(17, 2.5e-3, 14e-3, 18e-3, profile_shift_coefficient=0.25)
    wheel = Gear(43, 2.5e-3, 14e-3, 40e-3, profile_shift_coefficient=-0.25)
    crowned = Gear(25, 3e-3, 20e-3, 30e-3, modification=FlankModification(helix_crowning=6e-6))
    shifted = GearPair(pinion, wheel, 75e-3)
    of_crowned, at = GearPair(crowned, Gear(35, 3e-3, 20e-3, 40e-3), 90e-3), (0.0, 20e-6, 40e-6)
    return (
        LineLoadCase("spur 17/43", shifted, 0.05, 28.0, (10e-6, 25e-6), (SPUR_MESH,)),
        LineLoadCase("spur 25/35, crowned", of_crowned, 0.3, 85.0, at, (SPUR_MESH,)),
    )


def _fresh_helical_pairs() -> tuple[LineLoadCase, ...]:
    crowned = _helical(17, 40, 15.0, 2e-3, 20e-3, FlankModification(helix_crowning=5e-6))
    again, meshes = _helical(19, 29, 18.0, 3e-3, 14e-3), (HELICAL_MESH,)
    return (
        LineLoadCase("helical 17/40, crowned", crowned, 0.1, 30.0, (25e-6,), meshes),
        LineLoadCase("helical 17/40, crowned, edge", crowned, 0.1, 30.0, (10e-6,), meshes, -1),
        LineLoadCase("helical 19/29, at 0.7", again, 0.7, 40.0, (-12e-6,), meshes),
        LineLoadCase("helical 19/29, at 0.7, edge", again, 0.7, 40.0, (25e-6,), meshes, 1),
        LineLoadCase("helical 22/23", _helical(22, 23, 12.0, 2.5e-3, 12e-3), 0.0, 28.0, (10e-6, 0.0), meshes),
    )


BORES = {17: 18e-3, 40: 30e-3, 19: 30e-3, 29: 40e-3, 22: 25e-3, 23: 25e-3}
"""Bore diameters of the helical gears by their numbers of teeth, m."""


def _helical(
    first: int, second: int, helix: float, module: float, face: float, modification: FlankModification = PLAIN
) -> GearPair:
    """Return a helical pair at its sum of reference radii; the helix angle in degrees."""
    angle = math.radians(helix)
    pinion = Gear(first, module, face, BORES[first], helix_angle=angle, modification=modification)
    wheel = Gear(second, module, face, BORES[second], helix_angle=-angle)
    return GearPair(pinion, wheel, pinion.reference_radius + wheel.reference_radius)


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
        relative = {
            quantity: estimate.error / estimate.value if estimate.value else math.nan
            for quantity, estimate in (
                ("line_load_n_per_mm", flanks.largest_line_load),
                ("k_h_beta", flanks.largest_face_load_factor),
                ("edge_line_load_n_per_mm", flanks.edge_line_load),
            )
        }
        for row in rows:
            if float(row["misalignment_um"]) == round(1e6 * misalignment, 6):
                length, quantity = 1e-3 * float(row["length_mm"]), row["quantity"]
                value = _peak(flanks, quantity, length)
                peer = float(row["value"]), float(row["error"])
                stated = relative[quantity] * value
                yield ComparedPeak(case, misalignment, quantity, length, value, stated, *peer)


def _peak(flanks: LoadDistribution, quantity: str, length: float) -> float:
    """Return the largest mean over a length of the face: of lines clear of edges, at edges, of all."""
    if quantity == "edge_line_load_n_per_mm":
        return 1e-3 * flanks.edge_line_load.value
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


Row = tuple[float, str, float, float]
"""Misalignment in um, quantity, length of the face in mm, and its peak there."""


def peer_rows(case: LineLoadCase, mesh: PeerMesh) -> Iterator[Row]:
    """Yield the peaks of a peer on one mesh."""
    width = case.pair.face_width
    for misalignment, loads in peer_loads(case, mesh):
        by_pair = {load.ahead: load for load in loads}
        for part in (SLICES, STRETCHES):
            length = width / part
            at = 1e6 * misalignment, 1e3 * length
            clear = max(load.largest_mean(length) for ahead, load in by_pair.items() if ahead != case.edge)
            yield at[0], "line_load_n_per_mm", at[1], 1e-3 * clear
            if case.edge is None:
                yield at[0], "k_h_beta", at[1], face_load_factor(loads, width, length)
        if case.edge in by_pair:
            peak = by_pair[case.edge].largest_mean(width / SLICES)
            yield at[0], "edge_line_load_n_per_mm", 1e3 * width / SLICES, 1e-3 * peak


def publish() -> None:
    """Print the peaks of all peers on their meshes."""
    for case in line_load_cases():
        for mesh in case.meshes:
            for row in peer_rows(case, mesh):
                print(case.name, mesh, *row)


if __name__ == "__main__":
    publish()
