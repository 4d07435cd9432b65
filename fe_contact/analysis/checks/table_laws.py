"""Laws of mechanics on a finished table; a run whose table breaks one fails.

Axes: P positions, F loads, M misalignments, D center distances. A check gets a harmless value, such as 0
below a bound of 1, at points that are not solved. In a table of several base pitches only some are solved;
the others follow from derivatives.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fe_contact.analysis.checks.law import Law, LawCheck, location_text
from fe_contact.analysis.checks.lifting import deviations_in_mesh
from fe_contact.analysis.checks.neighbors import approach_steps, largest_steps
from fe_contact.analysis.pairs.operating_points import OperatingPoint
from fe_contact.contact import ContactProblem, ContactSolution
from fe_contact.contact.plain_touch import Touch
from fe_contact.contact.rough_strip import BREAKS, FLATTEST
from fe_contact.contact.single_pair import single_pair_deflection
from fe_contact.errors import SolveError
from fe_contact.flank.extent import Extent
from fe_contact.hertz import peak_pressure
from fe_contact.ste.fields import SteFields
from fe_contact.types import BoolArray, FloatArray

TOUCH = 1e-9
"""Accuracy of the gaps at touching points, m."""
BALANCE = 1e-8
"""Allowed error of the balance of forces, relative to the load."""
STRAIGHT = 1e-6
"""Allowed relative error of a compliance or pressure in linear contact: rounding in differences of loads."""
ONE_TO_ONE = 1e-6
"""Least compliance over the tangent compliance at the higher load where base pitches follow from derivatives.

Errors of derivatives may bend the curve there, but it must rise.
"""
LEVERS = 2.0
"""Allowed change of a compliance over the difference of lever arms. The largest in 160 random pairs is 1.3.
"""
FLATTEST_TOUCH = 0.2
"""Least curvature of touching modified flanks over the curvature of plain flanks."""

_RIGID = Law("lifting of rigid gears", "transmission error without load", "µm", 1e6)
_LOADED = Law("lifting under load", "transmission error", "µm", 1e6)
_RISING = Law("rise with load", "compliance between this load and the one below", "nm/N", 1e9)
_FROM_REST = Law("rise with load", "compliance between no load and this one", "nm/N", 1e9)
_STIFFENING = Law("stiffening with load", "compliance between this load and the one below", "nm/N", 1e9)
_PUSHING = Law("contacts push", "least force over the load")
_BALANCE = Law("balance of moments", "moment of the contact forces over the torque less one")
_RESIDUAL = Law("balance of moments", "residual of the equilibrium")
_SHARES = Law("shares of the load", "sum less one")
_ARM = Law("load within the face", "centroid of the load from mid-face", "mm", 1e3)
_PRESSURE = Law("pressure carries the load", "largest pressure", "MPa", 1e-6)
_NEIGHBORS = Law("continuity over positions", "step to the next position", "µm", 1e6)
_NO_LOAD_NEIGHBORS = Law("continuity without load", "step to the next position", "µm", 1e6)


def flattest_touch(touch: Touch) -> float:
    """Return the least curvature of modified flanks over plain ones; of crests that of their strip."""
    return FLATTEST if touch.offset.shape[-1] >= BREAKS else FLATTEST_TOUCH


def check_laws(
    table: SteFields,
    points: Sequence[OperatingPoint],
    solved: Sequence[tuple[ContactProblem, ContactSolution]],
    support: Sequence[ContactSolution] = (),
) -> tuple[LawCheck, ...]:
    """Check the laws of a table: the worst place under each, the nearest to its bound first.

    Parameters
    ----------
    points : sequence of OperatingPoint
        Operating points of the table, center distance running fastest.
    solved : sequence of (ContactProblem, ContactSolution)
        Problem of each in the first base pitch, and its solution.
    support : sequence of ContactSolution
        Solution at its support loads, if there are any.
    """
    distances = table.center_distance_change.size
    worst: dict[tuple[str, str], LawCheck] = {}
    for i, (point, (problem, solution)) in enumerate(zip(points, solved, strict=True)):
        solutions = (solution, *support[i : i + 1])
        alignment = _AlignmentLaws(table, point, problem, solutions, *divmod(i, distances))
        for law in alignment.laws():
            key = law.law, law.quantity
            if key not in worst or not law.ratio <= worst[key].ratio:  # a ratio of NaN is worse than any
                worst[key] = law
    return tuple(sorted(worst.values(), key=lambda law: -math.inf if law.broken else -law.ratio))


def require_laws(laws: Sequence[LawCheck], partial: object, result: str = "table") -> None:
    """Raise `SolveError` naming every broken law, its place and both numbers, with the `partial` result.

    `result` names the kind of the result, a noun in the singular.
    """
    broken = "; ".join(law.text for law in laws if law.broken)
    if broken:
        raise SolveError(f"the {result} breaks a law of mechanics and is no result: {broken}", partial)


@dataclass(frozen=True)
class _AlignmentLaws:
    """One misalignment m at one center distance d of a table; the first solution is at its loads."""

    table: SteFields
    point: OperatingPoint
    problem: ContactProblem
    solutions: tuple[ContactSolution, ...]
    m: int
    d: int

    def laws(self) -> Iterator[LawCheck]:
        """Yield its laws; loads at which no point is solved have none."""
        yield from self._lifting()
        yield from self._over_loads()
        yield from self._forces()
        yield from self._fields()
        yield from self._steps()

    @cached_property
    def _good(self) -> BoolArray:
        """Points (P, F) that are solved."""
        return np.asarray(~self.table.failed[:, :, self.m, self.d])

    @cached_property
    def _exact(self) -> BoolArray:
        """Positions (P,) that do not follow from derivatives, and whose strips are within the load patches.

        Strips that outgrow their patches have a linear law; the checks of assumptions report them.
        """
        solved = np.isfinite(self.table.residuals[:, :, self.m, self.d, 0]).any(axis=1)
        outgrown = np.any([solution.beyond.any(axis=1) for solution in self.solutions], axis=0)
        return np.asarray(solved & ~outgrown)

    @cached_property
    def _ste(self) -> FloatArray:
        """The transmission error (P, F), m."""
        return self.table.static_transmission_error[:, :, self.m, self.d]

    @cached_property
    def _no_load(self) -> FloatArray:
        """The transmission error without load (P,), m."""
        return self.table.no_load_transmission_error[:, self.m, self.d]

    @cached_property
    def _deviations(self) -> Extent:
        return deviations_in_mesh(self.point, self.table.position, self.table.pair)

    def _at(self, position: int, load: int | None = None) -> str:
        force = None if load is None else float(self.table.force[load])
        return location_text(self.table, position, self.m, self.d, force)

    def _lifting(self) -> Iterator[LawCheck]:
        """Bound the curve without load and under load by the deviations of the teeth in mesh."""
        low, high = np.asarray(self._deviations.low), np.asarray(self._deviations.high)
        alone = single_pair_deflection(self.point.contact.pair, self.problem, self.table.force)
        alone = np.tile(alone, (self._ste.shape[0] // len(alone), 1))  # in every base pitch
        rows = np.flatnonzero(np.isfinite(alone).all(axis=1))  # positions at which one pair can carry
        if not rows.size:
            return
        floor, ceiling = low - TOUCH, high + TOUCH
        yield _RIGID.between(
            self._no_load[rows], floor[rows], ceiling[rows], lambda p: self._at(int(rows[p]))
        )
        largest = np.where(self._good, self._ste, self._no_load[:, None]).max(axis=1)
        alone = alone * (1.0 + self._softening(largest)[:, None])
        # g + (g - d_0) + deflection of one pair alone; g largest deviation, d_0 the error without load
        bound = (2.0 * high - self._no_load)[:, None] + alone + TOUCH
        bound, ste = np.where(self._good, bound, 1.0)[rows], np.where(self._good, self._ste, 0.0)[rows]
        floor = np.where(self._good, floor[:, None], -1.0)[rows]
        yield _LOADED.between(ste, floor, bound, lambda p, f: self._at(int(rows[p]), int(f)))

    def _over_loads(self) -> Iterator[LawCheck]:
        """Check the rise with load: chords between loads lie between the tangents at their ends."""
        t, m, d = self.table, self.m, self.d
        force = np.concatenate([t.force, t.support_force])
        order = np.argsort(force)
        ste = np.concatenate([self._ste, t.support_transmission_error[:, :, m, d]], axis=1)[:, order]
        compliances = t.tangent_compliance[:, :, m, d], t.support_tangent_compliance[:, :, m, d]
        tangent = np.concatenate(compliances, axis=1)[:, order]
        force = force[order]
        chord = np.diff(np.concatenate([self._no_load[:, None], ste], axis=1), axis=1)
        chord = chord / np.diff(np.concatenate([[0.0], force]))
        largest = np.where(np.isfinite(ste), ste, self._no_load[:, None]).max(axis=1)
        bent, exact = STRAIGHT + self._softening(largest)[:, None], self._exact[:, None]
        minimum = np.where(exact, np.maximum(1.0 - bent, ONE_TO_ONE), ONE_TO_ONE) * tangent
        upper = np.where(exact, 1.0 + bent, np.inf) * tangent

        def at(position: int, load: int) -> str:
            return location_text(t, position, m, d, float(force[load]))

        good = np.isfinite(ste) & np.isfinite(chord)
        # the touching point without load is found apart from the contacts: the difference is TOUCH at most
        secant = (ste - self._no_load[:, None] + TOUCH) / force
        least = np.maximum(minimum - bent * tangent, ONE_TO_ONE * tangent)  # `bent` at both ends of the way
        solved = np.isfinite(ste)
        yield _FROM_REST.above(np.where(solved, secant, 1.0), np.where(solved, least, 0.0), at)
        if force.size > 1:
            rising, minimum = good[:, 1:], minimum[:, 1:]
            yield _RISING.above(
                np.where(rising, chord[:, 1:], 1.0),
                np.where(rising, minimum, 0.0),
                lambda p, f: at(p, f + 1),
            )
            good = good[:, 1:] & good[:, :-1]
            yield _STIFFENING.below(
                np.where(good, chord[:, 1:], 0.0),
                np.where(good, upper[:, :-1], 1.0),
                lambda p, f: at(p, f + 1),
            )

    def _softening(self, largest: FloatArray) -> FloatArray:
        """Return the relative change (P,) of a compliance by other causes than gaps that close.

        One cause are forces that move to tip edges. There the torque has another lever arm than the motion,
        so that the load is not the derivative of an energy by the deflection. The other is the rolling of
        flanks as they deflect by the `largest` amounts (P,), m: its part is the deflection over the module.
        """
        count, touch = len(self.problem.compliance), self.problem.candidates.touch
        carries = np.any([solution.force[:count].any(axis=1) for solution in self.solutions], axis=0)
        off = np.abs(touch.lever_1[:count] / touch.lever_2[:count] - 1.0)
        levers = LEVERS * np.where(carries, off, 0.0).max(axis=1)
        rolled = (largest - self._no_load) / self.point.contact.pair.pinion.normal_module
        return np.asarray(np.tile(levers, largest.size // count) + rolled)

    def _forces(self) -> Iterator[LawCheck]:
        """Bound forces of the first base pitch and residuals of all that were solved."""
        solution, candidates = self.solutions[0], self.problem.candidates
        force, load = solution.force, solution.load
        count = len(force)
        good = self._good[:count]
        minimum = np.minimum(force.min(axis=2), 0.0) / load
        yield _PUSHING.below(np.where(good, -minimum, 0.0), BALANCE, self._at)
        moment = np.einsum("pfm,pm->pf", force, candidates.torque_share[:count]) / load - 1.0
        yield _BALANCE.below(np.where(good, np.abs(moment), 0.0), BALANCE, self._at)
        residual = np.nan_to_num(self.table.residuals[:, :, self.m, self.d, 0])
        yield _RESIDUAL.below(np.where(self._good, residual, 0.0), BALANCE, self._at)

    def _fields(self) -> Iterator[LawCheck]:
        """Bound shares, centroid and pressure."""
        t, m, d = self.table, self.m, self.d
        share = t.load_share[:, :, m, d]
        yield _SHARES.below(np.where(self._good, np.abs(share.sum(axis=2) - 1.0), 0.0), BALANCE, self._at)
        minimum = np.where(self._good, np.maximum(-share.min(axis=2), 0.0), 0.0)
        yield _PUSHING.below(minimum, BALANCE, self._at)
        pair = self.point.contact.pair
        off = np.where(self._good, np.abs(t.face_centroid[:, :, m, d] - pair.common_face_center), 0.0)
        yield _ARM.below(off, 0.5 * pair.face_width * (1.0 + BALANCE), self._at)
        pressure = t.max_pressure[:, :, m, d]
        if t.edge_pressure.size:
            pressure = np.maximum(pressure, t.edge_pressure[:, :, m, d])
        bound = self._least_pressure(share)
        known = self._good & self._exact[:, None]
        yield _PRESSURE.above(np.where(known, pressure, 1.0), np.where(known, bound, 0.0), self._at)

    def _least_pressure(self, share: FloatArray) -> FloatArray:
        """Return the pressure (P, F) if each pair carried its share (P, F, N) evenly on flat flanks, Pa.

        Flanks are as flat as modifications can make them where they touch.
        """
        count, candidates = len(self.problem.compliance), self.problem.candidates
        pairs = np.unique(candidates.pair)
        can_touch = np.isfinite(candidates.gap[:count])
        widths, radii = (
            np.where(can_touch, values[:count], 0.0).reshape(count, pairs.size, -1)
            for values in (candidates.width, candidates.radius)
        )
        model = self.point.model
        flattest = flattest_touch(candidates.touch) if model.sloped or model.tooth_gaps else 1.0
        shape = len(share) // count, count, *share.shape[1:]
        carried = share.reshape(shape)[..., pairs - self.table.pair[0]] * self.table.force[:, None]
        radius = radii.max(axis=2)[:, None, :] / flattest
        with np.errstate(divide="ignore", invalid="ignore"):  # a pair without candidates has no width
            line_load = carried / widths.sum(axis=2)[:, None, :]
            pressure = peak_pressure(line_load, radius, self.problem.modulus)
        minimum = (1.0 - STRAIGHT) * np.nan_to_num(pressure, posinf=0.0).max(axis=3)
        return np.asarray(minimum.reshape(share.shape[:2]))

    def _steps(self) -> Iterator[LawCheck]:
        """Bound steps between neighboring positions; a model without tip edges has jumps at the handover."""
        if not self.point.model.corner_contact or self.table.position.size < 2:
            return
        t = self.table
        way = np.diff(t.position, append=t.position[0] + t.period) * self.point.contact.pair.base_pitch
        curves = np.concatenate([self._no_load[:, None], self._ste], axis=1)
        size = np.nanmax(curves, axis=0) - np.min(self._deviations.low)
        limit = largest_steps(self.point, self.problem, way, self._deviations, size) + TOUCH
        load = np.concatenate([[0.0], t.force])
        limit = limit + approach_steps(self.point.contact.pair, self.problem, len(way), load)
        step = np.nan_to_num(np.abs(np.roll(curves, -1, axis=0) - curves))
        yield _NO_LOAD_NEIGHBORS.below(step[:, 0], limit[:, 0], self._at)
        yield _NEIGHBORS.below(step[:, 1:], limit[:, 1:], self._at)
