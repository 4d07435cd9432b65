"""Discretization of a run from a pair, an accuracy and a contact model."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, replace

import numpy as np

from fe_contact.allowed_error import AllowedError
from fe_contact.compliance import PlaneHypothesis
from fe_contact.contact import ContactModel, PatchRule
from fe_contact.errors import increasing
from fe_contact.geometry import ParallelAxes, Toothing
from fe_contact.hertz import contact_modulus, half_width, relative_radius
from fe_contact.mesh import MeshRecipe, SectorRecipe
from fe_contact.options import AnalysisOptions
from fe_contact.planning.discretization import (
    SLICE_OVER_PATCH,
    Discretization,
    face_discretization,
    plane_discretization,
)
from fe_contact.types import BoolArray, FloatArray, Json

WIDER = 1.25
"""Least width of the wider patches, which measure the error by the width, over that of the patches."""
PATCHES_SEEN = 0.7
"""Part of the remaining second-order error that counts, over that change. Strips are not as narrow as points.
"""

EDGE_PATCH = 0.0125
"""Least length of the patch at a tip edge in modules: two to three elements of the tip (factors of two move
STE in corner contact by less than 0.05 %)."""
EDGE_SHARE = 0.5
"""Share of the largest load whose strip the patch at a tip edge follows. Another pair carries the rest there.
"""
WIDEST_STRIP = 0.225
"""Largest half-width of a strip in modules that patches and the local law follow. The receipt counts wider
ones.
"""
STRIP_OVER_LAW = 0.6
"""Largest strip over the reference length of the local law. The law is straight from 0.66 on."""
PATCH_SHARE = 0.5
"""Share of the largest load whose strips the load patches follow."""
SMALLEST_SUPPORT = 1e-3
"""Lowest support load over the largest load."""
LARGEST_SUPPORT = 2.0
"""Highest support load over the largest load: dynamic forces exceed the static ones."""
SUPPORT_RATIO = 5.0
"""Largest ratio of neighboring support loads."""
_REACH = 2.5
"""Spacings of the first nodes: interpolants take two nodes of the pitch before and three of the next one."""
POSITION_SHARE = 0.5
"""Part of a tolerance that the search of positions allows as interpolation error. It leaves 0.2 to 0.8 of
this.
"""
CLOSEST = 1.0 / 16.0
"""Least interpolation error that a search allows over the usual one."""
FLOOR_SHARE = 0.5
"""Part of the floor of a tolerance that positions use. Meshes and slices take most of the tolerance."""
_ROUNDING = 1e-6
"""Least ripple over the deflection that the search resolves."""


@dataclass(frozen=True)
class NodeRule:
    """The density of positions where none are requested."""

    start: int
    """Number of equally spaced nodes that the search begins with."""
    tolerance: float
    """Interpolation error to keep, as a fraction of each load's peak-to-peak STE."""
    maximum: int
    """Largest number of nodes."""
    assessed_pitches: int = 3
    """Number of base pitches of a longer period that the search assesses."""
    least_ripple: float = 0.0
    """Least peak-to-peak STE, m; smaller ones count as this."""

    def reached_by_neighbor(self, position: FloatArray) -> BoolArray:
        """Whether positions (P,) of a base pitch are nodes of interpolants in the neighboring pitches."""
        return np.minimum(position, 1.0 - position) * self.start < _REACH

    def searched(self, period: int) -> float:
        """Return in how many base pitches the search solves a position: beside those assessed at the ends."""
        probes = 4.0 * _REACH / self.start
        return 1.0 if period == 1 else (1.0 + probes) * min(self.assessed_pitches, period)

    def for_tolerance(self, allowed: AllowedError) -> NodeRule:
        """Return the rule by which positions take their share of a tolerance, and no more than usual."""
        share = POSITION_SHARE * allowed.relative / self.tolerance
        closer = min(max(share, CLOSEST), 1.0)
        limit = round(self.maximum / math.sqrt(closer))
        minimum = FLOOR_SHARE * allowed.least_scale * share / closer  # the floor is as asked, however close
        return replace(self, tolerance=closer * self.tolerance, maximum=limit, least_ripple=minimum)

    def ripple(self, curves: FloatArray) -> FloatArray:
        """Return the peak-to-peak STE (C,) in m of curves (P, C) in m that the tolerance is a part of."""
        minimum = np.maximum(self.least_ripple, _ROUNDING * np.abs(curves).max(axis=0))
        return np.asarray(np.maximum(np.ptp(curves, axis=0), minimum))


PLANE_NODES = NodeRule(64, 0.0015, 768, 64)
FACE_NODES = NodeRule(64, 0.005, 192, 3)
"""Rules of the placement in the plane and over the face. Positions cost a hundred times as much over the
face, and its curves are smoother.
"""


@dataclass(frozen=True)
class Plan:
    """Discretization of one run."""

    discretization: Discretization
    patch: PatchRule
    coarse_patch: PatchRule
    """`patch`, `coarse_patch`: Load patches, and wider ones, which the coarse meshes resolve."""
    remaining_patches: float
    """Error left over the change to the wider patches. It is of second order in the width, against patches as
    narrow as the strips of the largest load; 0 where the run has such narrow patches.
    """
    positions: int | None
    """Number of fixed positions, or None for adaptive nodes."""
    nodes: NodeRule
    """Rule by which adaptive nodes are placed."""
    load: FloatArray
    """Requested normal forces F_bn in N."""
    support: FloatArray
    """Further loads in N that carry the force extraction down to lift-off and into overload."""
    parts: tuple[str, ...]
    """Parts of the gears' bodies that the finite elements have, as in `ContactModel`."""
    level: str = "standard"
    """"draft", "medium", "standard" or "fine": that of the meshes."""

    def bodies(self, pair: ParallelAxes) -> tuple[Toothing, Toothing]:
        """Return both gears as their finite elements have them."""
        return pair.pinion.with_parts(self.parts), pair.wheel.with_parts(self.parts)

    def to_json(self) -> Json:
        """Return plain JSON."""
        return self.discretization.to_json() | {
            "patch": asdict(self.patch),
            "positions": self.positions or "adaptive",
            "load": self.load.tolist(),
            "support_load": self.support.tolist(),
        }


def make_plan(
    pair: ParallelAxes,
    load: FloatArray,
    options: AnalysisOptions,
    model: ContactModel,
    level: str = "standard",
    slices: int | None = None,
) -> Plan:
    """Choose meshes, slices, patches, positions and support loads.

    Parameters
    ----------
    load : ndarray
        Requested normal forces in N, increasing, > 0.
    model : ContactModel
        `across_face` asks for three dimensions, `finite_width` for a plane corrected towards them, `parts`
        for what the bodies have.
    level : str
        Of the meshes, unless the accuracy names one; `fe_contact.planning.planned` chooses it by the
        accuracy.
    slices : int, optional
        Of the face in three dimensions; default: those of the level.
    """
    level = options.level or level
    levels = increasing("load", load)
    discretization: Discretization
    if model.across_face:
        discretization = face_discretization(pair, level, slices)
    else:
        stress = options.model == "plane_stress"
        hypothesis = PlaneHypothesis.PLANE_STRESS if stress else PlaneHypothesis.PLANE_STRAIN
        discretization = plane_discretization(pair, level, hypothesis, model.finite_width)
    patches = patch_rules(pair, float(levels[-1]), discretization)
    nodes = FACE_NODES if model.across_face else PLANE_NODES
    if options.tolerance is not None:
        nodes = nodes.for_tolerance(options.tolerance)
    low, high = SMALLEST_SUPPORT * levels[-1], levels[0]
    below = max(math.ceil(math.log(high / low) / math.log(SUPPORT_RATIO)), 0) if high > low else 0
    support = np.concatenate([np.geomspace(low, high, below + 1)[:-1], [LARGEST_SUPPORT * levels[-1]]])
    return Plan(
        discretization,
        *patches,
        options.positions,
        nodes,
        levels,
        support,
        model.parts,
        level,
    )


def patch_rules(
    pair: ParallelAxes, force: float, discretization: Discretization
) -> tuple[PatchRule, PatchRule, float]:
    """Return the load patches, wider ones that measure their error, and the part of that change that is left.

    Patches are as wide as strips under half the largest load, and as the mesh asks; the wider ones as the
    coarse mesh asks, but no wider than a slice if that tells enough. `force` is the largest requested load in
    N. The local law reaches as far as the strips of any load, whatever the patches.
    """
    cosine = math.cos(pair.base_helix_angle)
    modulus = contact_modulus(pair.pinion.material, pair.wheel.material)
    edge_load = 4.0 * EDGE_SHARE * force * cosine / (pair.face_width * math.pi * modulus)
    least_half, law = wanted_patch(pair, force), longest_strip(pair, LARGEST_SUPPORT * force) / STRIP_OVER_LAW
    half, edge = _resolved(discretization, discretization.recipes)
    half, edge = max(half, least_half), max(edge, EDGE_PATCH * pair.pinion.normal_module)
    coarse, coarse_edge = _resolved(discretization, discretization.coarse_recipes)
    slice_width = pair.face_width / (SLICE_OVER_PATCH * discretization.slices)
    wider = max(min(coarse, slice_width), WIDER * half if half > least_half else half)
    left = (
        PATCHES_SEEN * (1.0 - (least_half / half) ** 2) / ((wider / half) ** 2 - 1.0)
        if half > least_half
        else 0.0
    )
    coarse_edge = max(coarse_edge, edge)
    return PatchRule(half, edge, edge_load, law), PatchRule(wider, coarse_edge, edge_load, law), left


def _resolved(
    discretization: Discretization, recipes: tuple[MeshRecipe | SectorRecipe, ...]
) -> tuple[float, float]:
    """Return the half-width of a load patch and the length of one at a tip edge that meshes resolve, m."""
    half = discretization.resolved * max(recipe.flank_size for recipe in recipes)
    return half, discretization.resolved_edge * max(recipe.tip_size for recipe in recipes)


def wanted_patch(pair: ParallelAxes, force: float) -> float:
    """Return the half-width in m of load patches for loads up to one in N, whatever the mesh.

    Bodies give way by a part in proportion to a^2 under a patch, and by 3/2 b^2 under a strip that widens
    with its load: patches are right for half of it.
    """
    return math.sqrt(1.5) * longest_strip(pair, PATCH_SHARE * force)


def longest_strip(pair: ParallelAxes, force: float) -> float:
    """Return the half-width in m of strips under a load in N, no more than `WIDEST_STRIP`."""
    return min(_widest_strip(pair, force), WIDEST_STRIP * pair.pinion.normal_module)


def _widest_strip(pair: ParallelAxes, force: float) -> float:
    """Hertz half-width in m at the pitch point under the whole force; no aligned contact is much wider."""
    roll_1, roll_2 = pair.roll_lengths(0.0, 0)
    cosine = math.cos(pair.base_helix_angle)
    radius = relative_radius(roll_1, pair.wheel.sign * roll_2) / cosine
    modulus = contact_modulus(pair.pinion.material, pair.wheel.material)
    return float(half_width(force * cosine / pair.face_width, radius, modulus))
