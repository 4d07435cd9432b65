"""Discretization of a run from a pair, an accuracy and a contact model.

A strip is the contact of two flanks under a line load, of the half-width b by Hertz. A load patch is the
area, of half-width a, over which the finite elements get the load of a strip; the local law replaces the
patch by the strip. Support loads are solved beside the requested ones, to carry the forces down to lift-off
and into overload.
"""

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
"""Least width of the wider patches, which measure the error by the patch width, over that of the patches."""
PATCHES_SEEN = 0.7
"""Share that counts of an error of second order in the patch width. The order holds for narrow patches;
strips are not that narrow.
"""

EDGE_PATCH = 0.0125
"""Least length of the patch at a tip edge in modules: two to three elements of the tip (factors of two move
STE in corner contact by less than 0.05 %)."""
EDGE_SHARE = 0.5
"""Share of the largest load whose strip sets the patch at a tip edge; another pair carries the rest there."""
WIDEST_STRIP = 0.225
"""Largest half-width of a strip, in modules, to which patches and the local law are fitted. The receipt
counts wider strips.
"""
STRIP_OVER_LAW = 0.6
"""Half-width of the largest strip over the reference length of the local law. From 0.66 on the law is a
straight line.
"""
PATCH_SHARE = 0.5
"""Share of the largest load whose strips set the width of load patches."""
SMALLEST_SUPPORT = 1e-3
"""Lowest support load over the largest load."""
LARGEST_SUPPORT = 2.0
"""Highest support load over the largest load: dynamic forces exceed the static ones."""
SUPPORT_RATIO = 5.0
"""Largest ratio of neighboring support loads."""
_REACH = 2.5
"""Distance from the end of a base pitch, in spacings of the first nodes, within which interpolants of the
neighboring pitch use the nodes: two of the pitch before and three of the pitch behind.
"""
POSITION_SHARE = 0.5
"""Part of a tolerance that the search of positions allows as interpolation error. The error that remains is
0.2 to 0.8 of this.
"""
CLOSEST = 1.0 / 16.0
"""Least interpolation error that a search allows, over that without a tolerance."""
FLOOR_SHARE = 0.5
"""Part of the floor of a tolerance that positions use; meshes and slices use most of the tolerance."""
_ROUNDING = 1e-6
"""Least peak-to-peak STE that the search resolves, over the deflection."""


@dataclass(frozen=True)
class NodeRule:
    """The density of positions where none are requested."""

    start: int
    """Number of equally spaced nodes that the search begins with."""
    tolerance: float
    """Largest interpolation error, over the peak-to-peak STE of each load."""
    maximum: int
    """Largest number of nodes."""
    assessed_pitches: int = 3
    """Number of base pitches of a longer period that the search assesses."""
    least_ripple: float = 0.0
    """Least peak-to-peak STE to which the error is relative, m."""

    def reached_by_neighbor(self, position: FloatArray) -> BoolArray:
        """Return which positions (P,) of a base pitch are nodes of interpolants in neighboring pitches."""
        return np.minimum(position, 1.0 - position) * self.start < _REACH

    def searched(self, period: int) -> float:
        """Return the mean number of base pitches in which the search solves a position.

        These are the assessed pitches and, near their ends, the neighboring ones.
        """
        neighbors = 4.0 * _REACH / self.start
        return 1.0 if period == 1 else (1.0 + neighbors) * min(self.assessed_pitches, period)

    def for_tolerance(self, tolerance: AllowedError) -> NodeRule:
        """Return the rule by which positions use their share of a tolerance.

        The interpolation error is never larger than without a tolerance, nor smaller than `CLOSEST` of that.
        """
        wanted = POSITION_SHARE * tolerance.relative / self.tolerance
        factor = min(max(wanted, CLOSEST), 1.0)
        limit = round(self.maximum / math.sqrt(factor))
        # tolerance times least ripple, the floor of the error, does not depend on the limits of the factor
        minimum = FLOOR_SHARE * tolerance.least_scale * wanted / factor
        return replace(self, tolerance=factor * self.tolerance, maximum=limit, least_ripple=minimum)

    def ripple(self, curves: FloatArray) -> FloatArray:
        """Return the peak-to-peak STE (C,) of curves (P, C), both m, to which the tolerance is relative."""
        minimum = np.maximum(self.least_ripple, _ROUNDING * np.abs(curves).max(axis=0))
        return np.asarray(np.maximum(np.ptp(curves, axis=0), minimum))


PLANE_NODES = NodeRule(start=64, tolerance=0.0015, maximum=768, assessed_pitches=64)
FACE_NODES = NodeRule(start=64, tolerance=0.005, maximum=192, assessed_pitches=3)
"""Rules of models in the plane and over the face. A position over the face costs a hundred times as much, and
its curves are smoother.
"""


@dataclass(frozen=True)
class Plan:
    """Discretization of one run."""

    discretization: Discretization
    patch: PatchRule
    coarse_patch: PatchRule
    """`patch`, `coarse_patch`: Load patches, and wider ones, which the coarse meshes resolve."""
    remaining_patches: float
    """Error by the width of the patches over the change of the result from the patches to the wider ones. The
    error is of second order in the width, and 0 where patches are as narrow as strips of the largest load.
    """
    positions: int | None
    """Number of fixed positions, or None for adaptive nodes."""
    nodes: NodeRule
    """Rule by which adaptive nodes are placed."""
    load: FloatArray
    """Requested normal forces F_bn in N."""
    support: FloatArray
    """Support loads, normal forces in N."""
    parts: tuple[str, ...]
    """Parts of the gears' bodies that the finite elements have, as in `ContactModel`."""
    level: str = "standard"
    """Level of the meshes: "draft", "medium", "standard" or "fine"."""

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
        `across_face` asks for three dimensions, `finite_width` for a plane corrected for the face width.
        `parts` are the parts of the bodies.
    level : str
        Level of the meshes, unless `options` name one; `fe_contact.planning.planned` chooses it by the
        accuracy.
    slices : int, optional
        Number of slices of the face in three dimensions; default: that of the level.
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
    # support loads: a geometric sequence up to the lowest requested load, without it, and one for overload
    low, high = SMALLEST_SUPPORT * levels[-1], levels[0]
    below = max(math.ceil(math.log(high / low) / math.log(SUPPORT_RATIO)), 0) if high > low else 0
    support = np.concatenate([np.geomspace(low, high, below + 1)[:-1], [LARGEST_SUPPORT * levels[-1]]])
    patch, coarse_patch, remaining_patches = patches
    return Plan(
        discretization=discretization,
        patch=patch,
        coarse_patch=coarse_patch,
        remaining_patches=remaining_patches,
        positions=options.positions,
        nodes=nodes,
        load=levels,
        support=support,
        parts=model.parts,
        level=level,
    )


def patch_rules(
    pair: ParallelAxes, force: float, discretization: Discretization
) -> tuple[PatchRule, PatchRule, float]:
    """Return the load patches, the wider patches, and the factor from their difference to the error.

    Patches are as wide as strips under half the largest load, or as wide as the mesh can resolve. The wider
    ones are as wide as the coarse mesh can resolve, but no wider than a slice, and at least `WIDER` times as
    wide if the mesh set the patches. `force` is the largest requested load in N. The local law holds for the
    strips of all loads, the support loads included.
    """
    cosine = math.cos(pair.base_helix_angle)
    modulus = contact_modulus(pair.pinion.material, pair.wheel.material)
    edge_load = 4.0 * EDGE_SHARE * force * cosine / (pair.face_width * math.pi * modulus)
    wanted, law = wanted_patch(pair, force), longest_strip(pair, LARGEST_SUPPORT * force) / STRIP_OVER_LAW
    half, edge = _resolved(discretization, discretization.recipes)
    half, edge = max(half, wanted), max(edge, EDGE_PATCH * pair.pinion.normal_module)
    coarse, coarse_edge = _resolved(discretization, discretization.coarse_recipes)
    slice_width = pair.face_width / (SLICE_OVER_PATCH * discretization.slices)
    wider = max(min(coarse, slice_width), WIDER * half if half > wanted else half)
    remaining = 0.0
    if half > wanted:  # the error grows with the square of the width
        remaining = PATCHES_SEEN * (1.0 - (wanted / half) ** 2) / ((wider / half) ** 2 - 1.0)
    coarse_edge = max(coarse_edge, edge)
    return PatchRule(half, edge, edge_load, law), PatchRule(wider, coarse_edge, edge_load, law), remaining


def _resolved(
    discretization: Discretization, recipes: tuple[MeshRecipe | SectorRecipe, ...]
) -> tuple[float, float]:
    """Return the half-width of a load patch and the length of one at a tip edge that meshes resolve, m."""
    half = discretization.resolved * max(recipe.flank_size for recipe in recipes)
    return half, discretization.resolved_edge * max(recipe.tip_size for recipe in recipes)


def wanted_patch(pair: ParallelAxes, force: float) -> float:
    """Return the half-width in m of load patches for loads up to `force`, N, whatever the mesh resolves.

    The deflection of the bodies has a part in proportion to a^2 under a patch, and to 3/2 b^2 under a strip
    that widens with its load. The patches are exact for `PATCH_SHARE` of the load.
    """
    return math.sqrt(1.5) * longest_strip(pair, PATCH_SHARE * force)


def longest_strip(pair: ParallelAxes, force: float) -> float:
    """Return the half-width in m of strips under a load in N, no more than `WIDEST_STRIP`."""
    return min(_widest_strip(pair, force), WIDEST_STRIP * pair.pinion.normal_module)


def _widest_strip(pair: ParallelAxes, force: float) -> float:
    """Return the half-width in m by Hertz at the pitch point under the whole force.

    No contact of aligned flanks is much wider.
    """
    roll_1, roll_2 = pair.roll_lengths(0.0, 0)
    cosine = math.cos(pair.base_helix_angle)
    radius = relative_radius(roll_1, pair.wheel.sign * roll_2) / cosine
    modulus = contact_modulus(pair.pinion.material, pair.wheel.material)
    return float(half_width(force * cosine / pair.face_width, radius, modulus))
