"""Change by flipping one effect, by the slice model: both states are estimated and compared."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from bounds import engineering
from fe_contact.allowed_error import AllowedError
from fe_contact.effects.composer import compose, flipped
from fe_contact.effects.effect import ContactScene, Effect, named
from fe_contact.effects.influence.deflection_budget import EstimatedCurve, Springs
from fe_contact.flank.extent import Extent
from fe_contact.types import FloatArray, Json
from model_studies.ablation import TRIFLE

# The size of an effect: what leaving it out changes at the nominal load. Whatever shows one shows this.

RIPPLE_FLOOR = 20e-9
"""m; per cent of a peak-to-peak below this are not given: it is what meshes and springs leave uncertain."""
_UM = 1e6
_NOTHING = 5e-5  # um and %, well below what two digits of any change that counts can show


@dataclass(frozen=True)
class Influence:
    """Change by leaving an effect out: without it less with it."""

    torque: float
    """On the driving gear, N m."""
    misalignment: float
    """m."""
    mean: float
    peak_to_peak: float
    """`mean`, `peak_to_peak`: Change of the static transmission error, m."""
    whole_mean: float
    whole_peak_to_peak: float
    """`whole_mean`, `whole_peak_to_peak`: The static transmission error with the effect, m."""

    @property
    def relative_mean(self) -> float:
        """Change of the mean over the mean with the effect."""
        return self.mean / self.whole_mean

    @property
    def relative_peak_to_peak(self) -> float | None:
        """Change of peak-to-peak over that with the effect; None where that is below `RIPPLE_FLOOR`."""
        quiet = self.whole_peak_to_peak < RIPPLE_FLOOR
        return None if quiet else self.peak_to_peak / self.whole_peak_to_peak

    @property
    def trifle(self) -> bool:
        """Whether both changes are below `TRIFLE`, or that of a vanishing ripple below `RIPPLE_FLOOR`."""
        ripple = self.relative_peak_to_peak
        small = abs(self.peak_to_peak) < RIPPLE_FLOOR if ripple is None else abs(ripple) < TRIFLE
        return small and abs(self.relative_mean) < TRIFLE

    @property
    def words(self) -> str:
        """Both changes in um and %."""
        ripple = self.relative_peak_to_peak
        share = f"of less than {_UM * RIPPLE_FLOOR:g} µm" if ripple is None else f"{signed(100 * ripple)} %"
        return (
            f"mean {signed(_UM * self.mean)} µm ({signed(100 * self.relative_mean)} %), "
            f"peak-to-peak {signed(_UM * self.peak_to_peak)} µm ({share})"
        )

    def to_json(self) -> Json:
        """Return plain JSON."""
        return {
            "torque_n_m": self.torque,
            "misalignment_m": self.misalignment,
            "mean_m": self.mean,
            "peak_to_peak_m": self.peak_to_peak,
            "whole_mean_m": self.whole_mean,
            "whole_peak_to_peak_m": self.whole_peak_to_peak,
            "relative_mean": self.relative_mean,
            "relative_peak_to_peak": self.relative_peak_to_peak,
            "trifle": self.trifle,
            "words": self.words,
        }


def signed(value: float) -> str:
    """Write a change with its sign in two digits, whole numbers from 100 on."""
    if abs(value) < _NOTHING:
        return "0"
    return f"{value:+.0f}" if abs(value) >= 99.5 else engineering(value, 2, "+")


@dataclass(frozen=True)
class EstimatedInfluence:
    """Estimated change by leaving an effect out: without it less with it."""

    mean: FloatArray
    peak_to_peak: FloatArray
    """`mean`, `peak_to_peak`: Of the static transmission error, m, at each load and the largest misalignment
    in size. Shape (L,) each.
    """
    whole: EstimatedCurve
    """With the effect, at the same places."""
    largest: float
    """Largest change of either in parts of the value with the effect, over all loads and both ends of the
    misalignments, >= 0.
    """


def largest_part(extent: Extent, mean: FloatArray, ripple: FloatArray, allowed: AllowedError) -> float:
    """Return the bound of the changes of mean and peak-to-peak by gaps that are left out.

    In parts of the sizes that a tolerance counts by: means and ripples (L, ...) in m.
    """
    of_mean = np.max(extent.reach / allowed.scale(mean))
    return float(max(of_mean, np.max(extent.span / allowed.scale(ripple))))


def estimate_influence(
    scene: ContactScene,
    choices: Mapping[str, str],
    name: str,
    least: float = 0.0,
) -> EstimatedInfluence | None:
    """Estimate what leaving the effect `name` out of the model changes.

    Parameters
    ----------
    choices : mapping of str to str
        Every effect "on" or "off"; all but `name` stay so.
    least : float
        Size in m that smaller means and ripples count as where a change is a part of them.

    Returns
    -------
    EstimatedInfluence or None
        None: one of the two states cannot be had, as a plane with what acts across the face, or the springs
        do not know it.
    """
    return estimate_influences(scene, choices, [name], least)[name]


def estimate_influences(
    scene: ContactScene,
    decided: Mapping[str, str],
    names: Sequence[str],
    least: float = 0.0,
) -> dict[str, EstimatedInfluence | None]:
    """Estimate several effects; parameters of `estimate_influence`."""
    known: dict[tuple[tuple[str, str], ...], list[EstimatedCurve]] = {}
    springs = Springs(scene.pair)
    face, width = named(scene.registry, "across_face"), named(scene.registry, "finite_width")
    uncorrected = decided.get(face) == "off" and decided.get(width) == "off"

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
            return _compared(curves(decided), curves(decided), least)
        with_it, without = (
            curves(
                decided
                if decided[effect.name] == choice
                else flipped(scene.registry, decided, effect.name, choice)
            )
            for choice in ("on", "off")
        )
        return _compared(with_it, without, least)

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
        model = compose(tilted, choices)[0]
        models.append(repr(model))
        if models[-1] not in curves:  # without misalignment both ends are one
            curves[models[-1]] = springs.curve(model, load)
    return [curves[model] for model in models]


def _compared(
    with_it: Sequence[EstimatedCurve], without: Sequence[EstimatedCurve], least: float
) -> EstimatedInfluence:
    """Take differences of the last curves, and the largest relative one of all."""
    changes = [
        (b.mean - a.mean, b.peak_to_peak - a.peak_to_peak) for a, b in zip(with_it, without, strict=True)
    ]
    relative = [
        np.abs((mean, ripple)) / np.maximum(np.abs((curve.mean, curve.peak_to_peak)), least)
        for (mean, ripple), curve in zip(changes, with_it, strict=True)
    ]
    return EstimatedInfluence(*changes[-1], with_it[-1], float(np.max(relative)))
