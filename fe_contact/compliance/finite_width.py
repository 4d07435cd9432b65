r"""Compliance of a spur gear of finite width beyond that of its section in plane strain.

The ends of the face are free: there the gear bulges along its axis, and S > S_strain. The load of a spur pair
is even across the face, so what counts is the mean displacement of a flank under an even load,

    S = b E' S_3D E,

E the map from profile nodes to even loads (and, transposed, from a flank to its mean over the face), b the
width. Near the load the gear is in plane strain but for its very ends, so the logarithm of the contact
cancels in S - S_strain, and so does most of the discretization if both are taken on one mesh, once free and
once held along the axis. What is left is smooth: a coarse mesh of half the face holds it, and it is added to
a fine plane solution.

The functions of the held mesh are among those of the free one, hence S - S_strain is positive semidefinite;
it vanishes with Poisson's ratio.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from fe_contact.compliance.cache import computed_once
from fe_contact.compliance.cyclic_compliance import compliance_key_3d, flank_compliance_3d
from fe_contact.compliance.flank import FlankCompliance, FlankCompliance3D
from fe_contact.errors import InputError
from fe_contact.geometry import Toothing
from fe_contact.mesh import SectorRecipe
from fe_contact.mesh.bore_support import ClampedBore, PlaneStrain
from fe_contact.types import FloatArray, IntArray


@dataclass(frozen=True)
class FiniteWidthCompliance:
    """Compliance of the flanks of a spur gear under even loads, beyond that in plane strain."""

    s: FloatArray
    """Flank coordinate of the nodes, m; quadratic elements as in `FlankCompliance`. Shape (k,)."""
    blocks: FloatArray
    """Mean displacement over the face of the flank of tooth m (row) per force on that of tooth 0 (column),
    both along the normal, and per unit face width, m / (N/m); of tooth -m: the transpose. Shape (reach + 1,
    k, k).
    """
    teeth: int
    """Number of teeth of the gear."""

    def block(self, ahead: int) -> FloatArray:
        """Return the (k, k) compliance of the tooth `ahead` of the loaded one; zero beyond the reach."""
        forward, reach = ahead % self.teeth, len(self.blocks) - 1
        if forward <= reach:
            return np.asarray(self.blocks[forward])
        if self.teeth - forward <= reach:
            return np.asarray(self.blocks[self.teeth - forward].T)
        return np.zeros_like(self.blocks[0])

    def added_to(self, flank: FlankCompliance) -> FlankCompliance:
        """Return the compliance of a transverse section in plane strain, corrected for the finite width."""
        shape = shape_functions(self.s, flank.s)
        count = flank.teeth.size
        added = {m: shape @ self.block(m) @ shape.T for m in range(1 - count, count)}
        rows = [np.concatenate([added[i - j] for j in range(count)], axis=1) for i in range(count)]
        return replace(flank, matrix=flank.matrix + np.concatenate(rows))


def finite_width_compliances(
    gears: Sequence[Toothing], recipes: Sequence[SectorRecipe], teeth: int, *, cache: Path | None = None
) -> tuple[FiniteWidthCompliance, ...]:
    """Return the compliance of each gear beyond plane strain; gears alike are computed once.

    Raises `InputError`: a helical gear, whose load is not even across the face; `MeshError`, `SolveError`: no
    acceptable mesh, a singular stiffness or a broken law.

    Parameters
    ----------
    gears : sequence of Toothing
        Spur gears, bores clamped. Modification plays no part. Of a sector it is that of the whole gear, whose
        free ends differ little.
    recipes : sequence of SectorRecipe
        Of half the face, one per gear; `SectorRecipe.even_load` is made for it.
    teeth : int
        Number of neighboring teeth that can carry load at once.
    cache : Path, optional
        Directory of kept compliances; None: neither read nor written.
    """
    for gear in gears:
        if gear.helix_angle != 0.0:
            raise InputError("gear.helix_angle", gear.helix_angle, "0", "Use the 3-D model for it.")
    gears = [gear.whole for gear in gears]
    keys = [
        compliance_key_3d(gear, recipe, 0, ClampedBore()) for gear, recipe in zip(gears, recipes, strict=True)
    ]
    return computed_once(keys, lambda i: _beyond_plane_strain(gears[i], recipes[i], teeth, cache))


def _beyond_plane_strain(
    gear: Toothing, recipe: SectorRecipe, teeth: int, cache: Path | None
) -> FiniteWidthCompliance:
    """Solve the solid, and the same mesh held along the axis: the same functions, but for the axial ones."""
    reach = min(teeth - 1, gear.teeth // 2)
    solid = flank_compliance_3d(gear, recipe, reach=reach, cache=cache)
    section = flank_compliance_3d(gear, recipe, reach=reach, support=PlaneStrain(), cache=cache)
    return FiniteWidthCompliance(solid.s, under_even_load(solid) - under_even_load(section), gear.teeth)


def under_even_load(compliance: FlankCompliance3D) -> FloatArray:
    """Return b E' S_m E (reach + 1, k, k): mean displacements per even force and unit face width."""
    even = even_load(compliance.z, compliance.index)
    width = float(compliance.z[-1] - compliance.z[0])
    return np.asarray(width * (even.T @ compliance.blocks @ even))


def even_load(z: FloatArray, index: IntArray) -> FloatArray:
    """Return the forces (nf, k) of loads that are even across the face, per total force at a profile node.

    The mean of an eight-node face over its width is quadratic along the profile, so that it has values at
    its three nodes: Simpson's rule on the two sides, and in the middle the mean of the two middles, 1/2 each,
    with 1/3 of the middles of the sides less 1/6 of the corners. A total force at a node has their shares.
    """
    count = index.shape[1]
    forces = np.zeros((int(index.max()) + 1, count))
    share = np.diff(z) / (z[-1] - z[0])
    sides, middles = np.arange(0, count, 2), np.arange(1, count, 2)
    for low, part in zip(range(0, len(index) - 1, 2), share, strict=True):
        for plane, simpson, neighbor_weight in ((low, 1.0, -1.0), (low + 1, 4.0, 2.0), (low + 2, 1.0, -1.0)):
            forces[index[plane, sides], sides] += part * simpson / 6.0
            for neighbor in (middles - 1, middles + 1):
                forces[index[plane, neighbor], middles] += part * neighbor_weight / 6.0
        for plane in (low, low + 2):
            forces[index[plane, middles], middles] += 0.5 * part
    return forces


def shape_functions(nodes: FloatArray, at: FloatArray) -> FloatArray:
    """Return the quadratic shape functions (n, k) of flank `nodes` (k,) at the coordinates `at` (n,).

    Below the first node its value holds.
    """
    ends = nodes[::2]
    inside = np.clip(at, ends[0], ends[-1])
    element = np.clip(np.searchsorted(ends, inside, side="right") - 1, 0, len(ends) - 2)
    x = 2.0 * (inside - ends[element]) / np.diff(ends)[element] - 1.0
    shape = np.zeros((len(at), len(nodes)))
    row = np.arange(len(at))
    for node, value in enumerate((0.5 * x * (x - 1.0), 1.0 - x**2, 0.5 * x * (x + 1.0))):
        shape[row, 2 * element + node] = value
    return shape
