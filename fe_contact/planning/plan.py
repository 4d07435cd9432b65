"""From a pair and an accuracy to the discretisation of a run."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass

import numpy as np

from fe_contact.checks import increasing, integer, positive, within
from fe_contact.compliance import PlaneHypothesis
from fe_contact.contact import PatchRule
from fe_contact.errors import InputError
from fe_contact.geometry import Gear, GearPair
from fe_contact.hertz import contact_modulus, half_width, relative_radius
from fe_contact.mesh import MeshRecipe
from fe_contact.types import FloatArray, Json

LEVELS = {"draft": 0.6, "standard": 1.0, "fine": 2.0}
"""Refinement of the standard mesh at each level."""

TABLE_TOLERANCE = 0.002
"""Interpolation error in position kept by adaptive nodes, as a fraction of each load's peak-to-peak STE."""

EDGE_PATCH = 0.0125
"""Length of the patch at a tip edge in modules: the contact length there under rated load (factors of two
move STE in corner contact by about 0.1 %)."""

BASE_POSITIONS = 64
SMALLEST_SUPPORT = 1e-3
"""Lowest support load over the largest load."""
LARGEST_SUPPORT = 2.0
"""Highest support load over the largest load: dynamic forces exceed the static ones."""
SUPPORT_RATIO = 5.0
"""Largest ratio of neighbouring support loads."""

MODELS = {
    "auto": PlaneHypothesis.PLANE_STRAIN,
    "plane_strain": PlaneHypothesis.PLANE_STRAIN,
    "plane_stress": PlaneHypothesis.PLANE_STRESS,
}


@dataclass(frozen=True)
class Accuracy:
    """What the caller asked for: exactly one of the first three, or none (then `level` = "standard").

    Attributes
    ----------
    tolerance : float, optional
        Relative error on mean and peak-to-peak STE.
    time_budget : float, optional
        Seconds.
    level : str, optional
        "draft", "standard" or "fine".
    model : str
        "auto", "plane_strain", "plane_stress" or "3d".
    positions : int, optional
        Fixed number of equally spaced positions; without it nodes are placed where the curve bends.
    """

    tolerance: float | None = None
    time_budget: float | None = None
    level: str | None = None
    model: str = "auto"
    positions: int | None = None

    def __post_init__(self) -> None:
        asked = [n for n in ("tolerance", "time_budget", "level") if getattr(self, n) is not None]
        if len(asked) > 1:
            raise InputError(
                asked[1],
                getattr(self, asked[1]),
                f"left out when {asked[0]} is given",
                "Ask for one of them.",
            )
        if self.tolerance is not None:
            within("tolerance", self.tolerance, 1e-4, 0.5, "0.01 means one per cent.")
        if self.time_budget is not None:
            positive("time_budget", self.time_budget, "Seconds.")
        if self.level is not None and self.level not in LEVELS:
            raise InputError("level", self.level, f"one of {', '.join(LEVELS)}")
        if self.model == "3d":
            raise InputError(
                "model",
                self.model,
                f"one of {', '.join(MODELS)}",
                "Three-dimensional models are not in this version.",
            )
        if self.model not in MODELS:
            raise InputError("model", self.model, f"one of {', '.join(MODELS)}")
        if self.positions is not None:
            integer(
                "positions",
                self.positions,
                8,
                4096,
                "64 resolve a spur pair; leave it out for adaptive nodes.",
            )

    @property
    def refinement(self) -> float:
        """Refinement of the standard mesh.

        The error of the standard mesh is a few 1e-4 and the mesh costs little in 2-D, so a looser tolerance
        or a shorter time is met by the draft mesh and only a tolerance below 0.002 asks for the fine one.
        """
        if self.level is not None:
            return LEVELS[self.level]
        if self.tolerance is not None:
            return LEVELS["fine"] if self.tolerance < 0.002 else LEVELS["standard"]
        if self.time_budget is not None:
            return LEVELS["draft"] if self.time_budget < 3.0 else LEVELS["standard"]
        return LEVELS["standard"]


@dataclass(frozen=True)
class Plan:
    """Discretisation of one run.

    Attributes
    ----------
    hypothesis : PlaneHypothesis
    recipes : (MeshRecipe, MeshRecipe)
        Driving and driven gear.
    coarse_recipes : (MeshRecipe, MeshRecipe)
        Half as fine, for the discretisation error.
    patch : PatchRule
    positions : int or None
        Fixed number, or None for adaptive nodes.
    load : ndarray
        Requested normal forces F_bn in N.
    support : ndarray
        Further loads in N that carry the force extraction down to lift-off and into overload.
    """

    hypothesis: PlaneHypothesis
    recipes: tuple[MeshRecipe, MeshRecipe]
    coarse_recipes: tuple[MeshRecipe, MeshRecipe]
    patch: PatchRule
    positions: int | None
    load: FloatArray
    support: FloatArray

    def to_json(self) -> Json:
        """Return plain JSON."""
        return {
            "model": self.hypothesis.value,
            "mesh": [r.content() for r in self.recipes],
            "patch": asdict(self.patch),
            "positions": self.positions or "adaptive",
            "load": self.load.tolist(),
            "support_load": self.support.tolist(),
        }


def make_plan(pair: GearPair, load: FloatArray, accuracy: Accuracy) -> Plan:
    """Choose meshes, patches, positions and load levels.

    Parameters
    ----------
    pair : GearPair
    load : ndarray
        Requested normal forces in N, increasing, > 0.
    accuracy : Accuracy
    """
    levels = increasing("load", load)
    recipes = tuple(_recipe(gear, accuracy.refinement) for gear in (pair.pinion, pair.wheel))
    coarse = tuple(recipe.refined(0.5) for recipe in recipes)
    return Plan(
        MODELS[accuracy.model],
        (recipes[0], recipes[1]),
        (coarse[0], coarse[1]),
        _patch_rule(pair, LARGEST_SUPPORT * levels[-1], max(recipe.flank_size for recipe in coarse)),
        accuracy.positions,
        levels,
        _support_loads(levels),
    )


def _recipe(gear: Gear, refinement: float) -> MeshRecipe:
    """Return the standard recipe of `gear`, refined."""
    standard = MeshRecipe.standard(gear)
    return standard if refinement == 1.0 else standard.refined(refinement)


def _support_loads(levels: FloatArray) -> FloatArray:
    """Return loads below the lowest and above the highest of `levels`."""
    low, high = SMALLEST_SUPPORT * levels[-1], levels[0]
    below = max(math.ceil(math.log(high / low) / math.log(SUPPORT_RATIO)), 0) if high > low else 0
    return np.concatenate([np.geomspace(low, high, below + 1)[:-1], [LARGEST_SUPPORT * levels[-1]]])


def _patch_rule(pair: GearPair, force: float, element: float) -> PatchRule:
    """Return patches wider than any contact strip and than one and a half elements of either mesh."""
    edge = EDGE_PATCH * pair.pinion.normal_module
    return PatchRule(max(1.5 * element, _widest_strip(pair, force) / 0.6), edge)


def _widest_strip(pair: GearPair, force: float) -> float:
    """Hertz half-width in m at the pitch point under the whole force; no aligned contact is much wider."""
    roll_1, roll_2 = pair.roll_lengths(0.0, 0)
    width = min(pair.pinion.face_width, pair.wheel.face_width)
    radius = relative_radius(roll_1, roll_2)
    return float(
        half_width(force / width, radius, contact_modulus(pair.pinion.material, pair.wheel.material))
    )
