"""Assumptions of a run, checked on its solution: neglected effects, ranges of its models."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from bounds import engineering
from fe_contact.allowed_error import AllowedError
from fe_contact.analysis.pairs.operating_points import OperatingPoint
from fe_contact.analysis.pairs.solved_contact import problems_in_parts
from fe_contact.analysis.pairs.tip_edges import edge_depth, handovers
from fe_contact.analysis.request.solved_run import SolvedRun
from fe_contact.analysis.tables import SolvedTable
from fe_contact.contact import solve_contact
from fe_contact.contact.touch import FLATTEST
from fe_contact.effects.effect import across_face
from fe_contact.effects.influence.estimate import estimate_influence, largest_part
from fe_contact.effects.misalignment import MisalignmentGap
from fe_contact.effects.tooth_deviations import sharpest_crest
from fe_contact.geometry.printed_data import backlash_rounding
from fe_contact.planning.plane_bias import plane_bias
from fe_contact.types import FloatArray, Json

MIN_BACKLASH = 1e-9
"""Least backlash that counts, m. Teeth without a thickness allowance have only rounding errors as backlash.
"""


@dataclass(frozen=True)
class Assumption:
    """One thing that a run took for granted."""

    effect: str
    """Effect that does without the assumption; empty if there is no such effect."""
    what: str
    """Text of the assumption."""
    holds: bool | None
    """Whether the assumption holds; None where it could not be assessed."""
    change: float
    """Largest change of mean or peak-to-peak that a wrong assumption makes, over the size that the tolerance
    counts by (`AllowedError.scale`); NaN: not known.
    """
    reason: str
    """Finding of the check, in words."""

    def to_json(self) -> Json:
        """Return plain JSON."""
        known = {"change": self.change} if np.isfinite(self.change) else {}
        return {
            "effect": self.effect,
            "assumption": self.what,
            "holds": self.holds,
            "reason": self.reason,
            **known,
        }


def check_assumptions(run: SolvedTable) -> tuple[Assumption, ...]:
    """Check all assumptions of a table on its results."""
    return (
        *_tip_edges(run, _ripples(run)),
        *_neglected_assumptions(run),
        *_plane(run),
        *_coast_flanks(run),
        *_printed_data(run),
        *_crests(run),
        _load_patches(run),
        _support_loads(run),
    )


def check_single_point(run: SolvedRun) -> tuple[Assumption, ...]:
    """Check the assumptions of flank results and root stress: depth of edges relative to the deflection."""
    return (*_tip_edges(run, np.abs(_means(run))), *check_cheaply(run))


def check_cheaply(run: SolvedRun) -> tuple[Assumption, ...]:
    """Check the assumptions that the solution alone can show."""
    return (*_plane(run), *_coast_flanks(run), *_printed_data(run), *_crests(run), _load_patches(run))


def _allowed_error(run: SolvedRun) -> AllowedError:
    return run.checked.request.options.allowed


def _tip_edges(run: SolvedRun, size: FloatArray) -> Iterator[Assumption]:
    """Check, where corner contact is neglected, that no tip edge touches its mate before A and after E.

    A contact that is left out carries at most until the deflection has fallen to its gap. So STE changes by
    no more than the deflection exceeds the gap; the change is relative to `size` (L, places) in m.
    """
    if not run.edges_neglected:
        return
    effect = run.checked.request.named("corner_contact")
    pairs = zip(run.places.places, run.edge_depths, strict=True)
    deepest = [np.maximum(depth, _at_handovers(point, run.plan.load)) for point, depth in pairs]
    depth = np.stack(deepest, axis=1)
    # a curve without ripple has the size 0, which rounding of its mean replaces
    scale = np.maximum(_allowed_error(run).scale(size), 1e-12 * np.abs(_means(run)))
    change = float(np.max(depth / scale))
    reason = "the gaps at the tip edges stay open"
    if depth.any():
        largest = engineering(1e6 * float(depth.max()), 2)
        reason = f"teeth bend {largest} µm beyond the gap at a tip edge"
    yield Assumption(effect, "tip edges stay clear", change <= _allowed_error(run).relative, change, reason)


def _at_handovers(point: OperatingPoint, load: FloatArray) -> FloatArray:
    """Return the depth of tip edges (L,) in m where pairs come into contact and leave it.

    There the gap of an edge is least, and the positions of a run may pass it by.
    """
    pitches, position = np.arange(point.model.period), handovers(point.contact.pair)
    parts = problems_in_parts(point, position, pitches)
    depths = [edge_depth(point, part, solve_contact(part, load)) for part in parts]
    return np.asarray(np.max(depths, axis=0))


def _neglected_assumptions(run: SolvedTable) -> Iterator[Assumption]:
    """Check the effects neglected for the tolerance: estimate and bound of their influence."""
    allowed, means, ripples = _allowed_error(run), _means(run), _ripples(run)
    for name in run.checked.request.neglected:
        scene, model = run.checked.assessing(name)
        influence = estimate_influence(scene, model, name)
        if influence is not None:
            mean = np.abs(influence.mean)[:, None] / allowed.scale(means)
            ripple = np.abs(influence.peak_to_peak)[:, None] / allowed.scale(ripples)
            estimate = float(np.max(np.maximum(mean, ripple)))
            bound = largest_part(scene.effect(name).extent(scene), means, ripples, allowed)
            reason = f"estimated at {allowed.part_text(estimate)} of what was computed"
            if bound:
                reason += f"; its gaps change at most {allowed.part_text(bound)}"
            change = max(estimate, bound)
            yield Assumption(
                name, "neglected effects are negligible", change <= allowed.relative, change, reason
            )


def _plane(run: SolvedRun) -> Iterator[Assumption]:
    """Check the assumptions of the plane: uniform load over the face, correction for the finite width."""
    request, model = run.checked.request, run.checked.model
    if model.across_face:
        return
    reasons = across_face(request.scene)
    reason = "; ".join(reasons) if reasons else "nothing in the scene acts across it"
    face, width = request.model_effects
    yield Assumption(face, "uniform load over the face", not reasons, float("nan"), reason)
    if bias := plane_bias(run.places.places[0].contact.pair, run.plan.discretization):
        missing = abs(bias.mean)
        reason = f"the finite width changes about {engineering(100 * missing, 2)} % of the mean"
        holds = missing <= _allowed_error(run).relative
        yield Assumption(width, "plane strain over the whole face", holds, missing, reason)


def _coast_flanks(run: SolvedRun) -> Iterator[Assumption]:
    """Check that the coast flanks stay apart, since the contact analysis has the driving flanks alone."""
    clearances = []
    for point, (_, solution) in zip(run.places.places, run.solved, strict=True):
        pair = point.contact.pair
        if pair.transverse_base_backlash <= MIN_BACKLASH:
            reason = "the teeth have no stated backlash: coast flanks were not assessed"
            yield Assumption("", "coast flanks stay apart", None, float("nan"), reason)
            return
        backlash = pair.transverse_base_backlash + float(np.min(solution.no_load))
        clearances.append(backlash - _closing(point))
    minimum = 1e6 * min(clearances)
    reason = f"the least clearance is {minimum:.3g} µm"
    if minimum <= 0:
        reason = f"the teeth jam by {-minimum:.3g} µm"
    yield Assumption("", "coast flanks stay apart", minimum > 0, float("nan"), reason)


def _printed_data(run: SolvedRun) -> Iterator[Assumption]:
    """State that nominal teeth which jam by no more than rounding of printed data have no backlash."""
    pair = run.places.places[0].contact.pair
    if pair.rounding_jam > MIN_BACKLASH:
        rounding = backlash_rounding(pair.pinion, pair.wheel, pair.center_distance)
        reason = (
            f"jam of {engineering(1e6 * pair.rounding_jam, 2)} µm is rounding of the printed data, which "
            f"makes up to {engineering(1e6 * rounding, 2)} µm; computed as zero backlash"
        )
        yield Assumption("", "nominal teeth do not jam", True, float("nan"), reason)


def _closing(point: OperatingPoint) -> float:
    """Return how far deviations and misalignment close the coast side beyond the driving side, m."""
    tilts = [term for term in point.model.gaps if isinstance(term, MisalignmentGap)]
    reach = sum(term.reach(point.contact.pair) for term in tilts)
    return reach + sum(term.largest for term in point.model.tooth_gaps)


def _crests(run: SolvedRun) -> Iterator[Assumption]:
    """Check that flanks with waves touch in one place: troughs are flatter than the mate is curved."""
    point = run.places.places[0]
    sharpest = sharpest_crest(point.contact.pair) if point.model.tooth_gaps else 0.0
    if sharpest:
        reason = f"waves and traces are at most {engineering(sharpest, 2)} times as curved as the flanks"
        holds = sharpest <= 1.0 - FLATTEST
        yield Assumption("", "flanks touch in one place", holds, float("nan"), reason)


def _load_patches(run: SolvedRun) -> Assumption:
    wider = sum(int(solution.beyond.sum()) for _, solution in run.solved)
    reason = f"strips are wider at {wider} points" if wider else "all strips are narrower"
    return Assumption("", "contact strips within the load patches", wider == 0, float("nan"), reason)


def _support_loads(run: SolvedTable) -> Assumption:
    """Check that the forces for dynamics are solved from lift-off to twice the largest load."""
    failed = sum(int(np.count_nonzero(point.solution.status)) for point in run.support)
    reason = "all points beyond the requested loads are solved"
    if failed:
        reason = f"{failed} points have no solution"
    return Assumption("", "forces solved from lift-off to overload", failed == 0, float("nan"), reason)


def _means(run: SolvedRun) -> FloatArray:
    """Return the mean STE (L, places), m, over the nodes that have a solution; infinite where none has."""
    return _over_nodes(run, np.mean)


def _ripples(run: SolvedRun) -> FloatArray:
    """Return the peak-to-peak STE (L, places), m; as `_means`."""
    return _over_nodes(run, np.ptp)


def _over_nodes(run: SolvedRun, figure: Callable[..., Any]) -> FloatArray:
    """Take a figure of every curve, its failed points left out: failures are reported by themselves."""
    solutions = [solution for _, solution in run.solved]
    figures = np.full((len(solutions), solutions[0].load.size), np.inf)
    for place, solution in enumerate(solutions):
        for load, curve in enumerate(solution.deflection.T):
            known = curve[np.isfinite(curve)]
            if known.size:
                figures[place, load] = figure(known)
    return figures.T
