"""Change by flipping one effect, by the slice model: both states are estimated and compared."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from fe_contact.allowed_error import AllowedError
from fe_contact.effects.composer import compose, flipped
from fe_contact.effects.effect import ContactScene, Effect, named
from fe_contact.effects.influence.estimated_curve import EstimatedCurve, Springs
from fe_contact.flank.extent import Extent
from fe_contact.types import FloatArray


@dataclass(frozen=True)
class EstimatedInfluence:
    """Estimated change by leaving an effect out: without it less with it."""

    mean: FloatArray
    peak_to_peak: FloatArray
    """`mean`, `peak_to_peak`: Change of the static transmission error, m, at each load and the misalignment
    of the largest size. Shape (L,) each.
    """
    full: EstimatedCurve
    """Estimated curve with the effect, at the same operating points."""
    largest: float
    """Largest relative change of mean or peak-to-peak, over the value with the effect, at all loads and both
    ends of the misalignments, >= 0.
    """


def largest_part(extent: Extent, mean: FloatArray, ripple: FloatArray, tolerance: AllowedError) -> float:
    """Return the bound of the changes of mean and peak-to-peak by gaps that are left out.

    In parts of the sizes that a tolerance counts by: means and ripples (L, ...) in m.
    """
    of_mean = np.max(extent.reach / tolerance.scale(mean))
    return float(max(of_mean, np.max(extent.span / tolerance.scale(ripple))))


def estimate_influence(
    scene: ContactScene,
    choices: Mapping[str, str],
    name: str,
    minimum: float = 0.0,
) -> EstimatedInfluence | None:
    """Estimate the change of results without the effect `name` of the model.

    Parameters
    ----------
    choices : mapping of str to str
        Every effect "on" or "off"; all but `name` stay so.
    minimum : float
        Size in m that smaller means and ripples count as where a change is a part of them.

    Returns
    -------
    EstimatedInfluence or None
        None: one of the two states cannot be had, as a plane with what acts across the face, or the springs
        do not know it.
    """
    return estimate_influences(scene, choices, [name], minimum)[name]


def estimate_influences(
    scene: ContactScene,
    decision: Mapping[str, str],
    names: Sequence[str],
    minimum: float = 0.0,
) -> dict[str, EstimatedInfluence | None]:
    """Estimate several effects; parameters of `estimate_influence`."""
    known: dict[tuple[tuple[str, str], ...], list[EstimatedCurve]] = {}
    springs = Springs(scene.pair)
    face, width = named(scene.registry, "across_face"), named(scene.registry, "finite_width")
    uncorrected = decision.get(face) == "off" and decision.get(width) == "off"

    def curves(choices: Mapping[str, str]) -> list[EstimatedCurve]:
        key = tuple(sorted(choices.items()))
        if key not in known:
            known[key] = _curves(scene, choices, springs)
        return known[key]

    def influence_of(effect: Effect) -> EstimatedInfluence | None:
        if not effect.estimable(scene):
            return None
        if effect.name == face and uncorrected:
            return influence_of(scene.effect(width))
        if effect.name == face or effect.called_for(scene).neutral:
            # with nothing across the face the corrected plane stands in for three dimensions
            return _estimated_influence(curves(decision), curves(decision), minimum)
        with_it, without = (
            curves(
                decision
                if decision[effect.name] == choice
                else flipped(scene.registry, decision, effect.name, choice)
            )
            for choice in ("on", "off")
        )
        return _estimated_influence(with_it, without, minimum)

    return {effect.name: influence_of(effect) for effect in scene.registry if effect.name in names}


def _curves(scene: ContactScene, choices: Mapping[str, str], springs: Springs) -> list[EstimatedCurve]:
    """Estimate the curves at both ends of the misalignments, the larger one last."""
    other = scene.misalignment[0] if scene.largest_misalignment > 0.0 else scene.misalignment[-1]
    ends = list(dict.fromkeys((float(other), scene.largest_misalignment)))
    load = scene.pair.normal_force(scene.torque)
    curves: dict[str, EstimatedCurve] = {}
    models = []
    for growth in ends:
        tilted = replace(scene, misalignment=np.array([growth]))
        model, _ = compose(tilted, choices)
        models.append(repr(model))
        if models[-1] not in curves:  # without misalignment both ends are one
            curves[models[-1]] = springs.curve(model, load)
    return [curves[model] for model in models]


def _estimated_influence(
    with_it: Sequence[EstimatedCurve], without: Sequence[EstimatedCurve], minimum: float
) -> EstimatedInfluence:
    """Take differences of the last curves, and the largest relative one of all."""
    changes = [
        (b.mean - a.mean, b.peak_to_peak - a.peak_to_peak) for a, b in zip(with_it, without, strict=True)
    ]
    relative = [
        np.abs((mean, ripple)) / np.maximum(np.abs((curve.mean, curve.peak_to_peak)), minimum)
        for (mean, ripple), curve in zip(changes, with_it, strict=True)
    ]
    return EstimatedInfluence(*changes[-1], with_it[-1], float(np.max(relative)))
