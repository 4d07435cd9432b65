"""Laws of mechanics on flank results; results that break one are refused."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fe_contact.analysis.checks.law import Law, LawCheck
from fe_contact.analysis.checks.table_laws import BALANCE, STRAIGHT, flattest_touch
from fe_contact.analysis.flanks.load_distribution import LoadDistribution
from fe_contact.contact import ContactProblem
from fe_contact.hertz import half_width, peak_pressure
from fe_contact.types import FloatArray

_Places = tuple[NDArray[np.intp], ...]

OVERLAP = 1e-6
"""Allowed overlap of flanks over the largest deflection: accuracy of the gaps that the solver closes."""

_PUSHING = Law("contacts push", "force pulling over the load")
_PRESSING = Law("contacts push", "pressure below zero over the largest")
_BALANCE = Law("balance of moments", "moment of the contact forces over the torque less one")
_LINE_LOAD = Law("line loads carry the load", "moment of the line loads over the torque less one")
_ARM = Law("load within the face", "centroid of the load from the middle of the common face", "mm", 1e3)
_TILTING = Law("balance of moments", "centroid of the forces off that of the slices", "µm", 1e6)
_OVERLAP = Law("flanks do not overlap", "overlap over the largest deflection")
_LOADED_GAP = Law("flanks touch where they carry", "force times gap over load times deflection")
_FLATTEST = Law("pressure carries the line load", "pressure", "MPa", 1e-6)
_SHARPEST = Law("pressure of the sharpest contact", "pressure", "MPa", 1e-6)


def check_flank_laws(flanks: LoadDistribution, problem: ContactProblem) -> tuple[LawCheck, ...]:
    """Check the laws of flank results: the worst place under each, the nearest to its bound first.

    Parameters
    ----------
    flanks : LoadDistribution
        Of P positions, N pairs and K stretches.
    problem : ContactProblem
        Its candidates (P, N K), touching points with their modification.
    """
    laws = list(_Flanks(flanks, problem).laws())
    return tuple(sorted(laws, key=lambda law: -math.inf if law.broken else -law.ratio))


@dataclass(frozen=True)
class _Flanks:
    """Flank results and the problem that they solve."""

    flanks: LoadDistribution
    problem: ContactProblem

    def laws(self) -> Iterator[LawCheck]:
        """Yield all laws."""
        yield from self._forces()
        yield from self._moments()
        yield from self._gaps()
        yield from self._pressures()

    def _at(self, position: int, pair: int | None = None, stretch: int | None = None) -> str:
        flanks = self.flanks
        parts = [f"position {flanks.position[position]:.6g}"]
        if pair is not None:
            parts.append(f"pair {int(flanks.pair[pair]):+d}")
        if stretch is not None:
            parts.append(f"face position {1e3 * flanks.face_position[stretch]:.4g} mm")
        return ", ".join(parts)

    def _forces(self) -> Iterator[LawCheck]:
        """Bound forces and pressures from below, and the sums of forces and of line loads."""
        flanks = self.flanks
        load = flanks.scene.normal_force
        yield _PUSHING.below(np.maximum(-flanks.force, 0.0) / load, BALANCE, self._at)
        largest = np.maximum(np.max(flanks.pressure), np.finfo(float).tiny)
        yield _PRESSING.below(np.maximum(-flanks.pressure, 0.0) / largest, BALANCE, self._at)
        moment = (flanks.force * flanks.lever).sum(axis=(1, 2)) / load
        yield _BALANCE.below(np.abs(moment - 1.0), BALANCE, self._at)
        low, high = flanks.scene.common_face
        length = (high - low) / flanks.face_position.size / math.cos(flanks.base_helix_angle)
        carried = (flanks.line_load * flanks.lever).sum(axis=(1, 2)) * length / load
        yield _LINE_LOAD.below(np.abs(carried - 1.0), BALANCE, self._at)

    def _moments(self) -> Iterator[LawCheck]:
        """Bound the centroid: on the face, and that of the forces on the slices of the bodies."""
        flanks, candidates = self.flanks, self.problem.candidates
        low, high = flanks.scene.common_face
        off = np.abs(flanks.load_centroid - 0.5 * (low + high))
        yield _ARM.below(off, 0.5 * (high - low) * (1.0 + BALANCE), self._at)
        of_points = flanks.force.sum(axis=1)
        on_slices = candidates.on_slices(flanks.force.reshape(len(of_points), -1))
        arms = [
            (forces @ face) / forces.sum(axis=1)
            for forces, face in (
                (of_points, flanks.face_position),
                (on_slices, candidates.slices.face_position),
            )
        ]
        yield _TILTING.below(np.abs(arms[0] - arms[1]), (high - low) * BALANCE, self._at)

    def _gaps(self) -> Iterator[LawCheck]:
        """Bound the gaps of loaded flanks from below, and their forces where a gap is left."""
        flanks = self.flanks
        deflection = float(np.max(np.abs(flanks.deflection)))
        yield _OVERLAP.below(np.maximum(-flanks.gap, 0.0) / deflection, OVERLAP, self._at)
        closed = flanks.force == 0.0
        gap = np.where(closed, 0.0, np.abs(flanks.gap))
        relative_gap = np.abs(flanks.force) * gap / (flanks.scene.normal_force * deflection)
        yield _LOADED_GAP.below(relative_gap, BALANCE, self._at)

    def _pressures(self) -> Iterator[LawCheck]:
        """Bound pressures by those of Hertz under their line loads on the flattest and sharpest gaps.

        If a gap rises at least as a parabola, the strip on it is at most as long as that on the parabola, and
        holds the touching point. The pressure over E* is the mean of g' sin t over the strip. It is at most
        that of all curvatures and kinks within reach of the strip.
        """
        flanks, modulus = self.flanks, self.problem.modulus
        rows = len(flanks.force)
        loaded = np.nonzero(flanks.force.reshape(rows, -1) > 0.0)
        if not loaded[0].size:
            return
        candidates = self.problem.candidates
        about = candidates.gap_at(loaded)
        load = flanks.force.reshape(rows, -1)[loaded] / candidates.width[loaded]
        plain, longest = candidates.radius[loaded], self._longest(loaded, load)
        near = np.abs(about.offset) < 2.0 * longest[:, None]
        bends, kinks = (
            np.where(near, np.abs(values), 0.0).sum(axis=-1) for values in (about.bend, about.jump)
        )
        parabola = (bends == 0.0) & (kinks == 0.0) & (np.abs(about.curvature * plain - 1.0) < STRAIGHT)
        radius = np.where(parabola, plain, plain / flattest_touch(candidates.touch))
        longest = np.where(parabola, half_width(load, plain, modulus), longest)
        # largest pressure over E*: of all curvature within the strip, and of all kinks at their worst place
        kinked = 0.5 * (about.curvature + bends) * longest + (kinks + np.abs(about.slope)) / math.pi
        pressure = flanks.pressure.reshape(rows, -1)[loaded]
        minimum = (1.0 - STRAIGHT) * peak_pressure(load, radius, modulus)
        yield _FLATTEST.above(pressure, minimum, self._among(loaded))
        yield _SHARPEST.below(pressure, (1.0 + STRAIGHT) * modulus * kinked, self._among(loaded))

    def _longest(self, places: _Places, load: FloatArray) -> FloatArray:
        """Return the half strips (k,) in m under line loads in N/m on flanks as flat as they can be."""
        candidates = self.problem.candidates
        radius = candidates.radius[places] / flattest_touch(candidates.touch)
        return half_width(load, radius, self.problem.modulus)

    def _among(self, places: _Places) -> Callable[..., str]:
        """Return a function that names a place by its number among `places`, indices of arrays (P, N K)."""
        stretches = self.flanks.face_position.size
        return lambda i: self._at(int(places[0][i]), *divmod(int(places[1][i]), stretches))
