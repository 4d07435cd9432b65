"""Tooth sectors of a gear of finite width under flank loads on several teeth, expanded from their flanks.

The ring of teeth is closed for every loaded tooth as if it were tooth 0; the fields of the others follow by
turning. A sector's inside follows from its flank and both cuts (`Condensation.expand`).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from fe_contact.compliance.condensed_gear import CondensedGear, condensed_tooth, element_forces
from fe_contact.compliance.cyclic_ring import RingSolution, loaded_cuts
from fe_contact.compliance.deformed_gear import DeformedGear, nodal_mean, stress_of, turn_about_axis
from fe_contact.compliance.plane_elasticity import PlaneHypothesis
from fe_contact.compliance.sector_stiffness import (
    REFERENCE,
    determinants,
    gradients,
    hexahedra,
    node_axes,
    placed_layer,
    twist,
)
from fe_contact.errors import InputError
from fe_contact.geometry import Toothing
from fe_contact.mesh.quad_sector import QuadSector, quad_sector
from fe_contact.mesh.quality import quad_quality
from fe_contact.mesh.recipe import SectorRecipe
from fe_contact.mesh.sector_grid import bore_support
from fe_contact.mesh.swept_sector import LOWER_FACE, SweptSector, swept_sector
from fe_contact.types import FloatArray, IntArray
from model_studies.stage_clock import StageClock

# The hexahedra of one tooth sector in space: nodes, displacements from freedoms, stresses, quality.


# Points where the stress of a 20-node hexahedron is most exact: two Gauss points each way, in -1 .. 1.
INNER = REFERENCE[:8] / np.sqrt(3.0)


@dataclass(frozen=True)
class _Part:
    """One batch: its elements (c, m) and, in the frame of its layers, what turns freedoms into stresses."""

    elements: IntArray
    frames: FloatArray
    """Cartesian displacement per freedom. Shape (m, 60, 60)."""
    gradient: FloatArray
    """Gradients of the functions at `INNER`. Shape (m, 8, 20, 3)."""
    turns: FloatArray
    """From the frame of each layer to that of mid-face. Shape (c, 3, 3)."""


@dataclass(frozen=True)
class _SectorElements:
    """The elements of one sector, in the frame of mid-face, tooth on +y."""

    nodes: FloatArray
    """m, in the order of `SweptSector.elements`, which is VTK's; none of an elastic seat. Shape (e, 20, 3).
    """
    numbers: IntArray
    """Point of each; nodes that hang on a coarser face have points of their own. Shape (e, 20)."""
    points: int
    """Number of points."""
    quality: dict[str, FloatArray]
    """By name, (e,)."""
    sector: SweptSector
    lame: tuple[float, float]
    parts: tuple[_Part, ...]

    def displacement(self, field: FloatArray) -> FloatArray:
        """Return the displacement (e, 20, 3) in m at the nodes for the freedoms `field` (n,)."""
        freedoms = self.sector.element_freedoms
        local = np.where(freedoms >= 0, field[freedoms], 0.0)
        moved = np.empty_like(self.nodes)
        for part in self.parts:
            values = np.einsum("mij,cmj->cmi", part.frames, local[part.elements])
            values = values.reshape(*part.elements.shape, 20, 3)
            moved[part.elements] = np.einsum("cxy,cmpy->cmpx", part.turns, values)
        return moved

    def stress(self, moved: FloatArray) -> FloatArray:
        """Return the stress (e, 20, 3, 3) in Pa at the nodes for displacements (e, 20, 3)."""
        stress = np.empty((*moved.shape, 3))
        for part in self.parts:
            # gradients are known in the frame of the layer: turn the displacement into it, the stress out
            local = np.einsum("cxy,cmpx->cmpy", part.turns, moved[part.elements])
            gradient = np.einsum("mqpi,cmpj->cmqij", part.gradient, local)
            inner = stress_of(gradient, self.lame)
            nodal = np.einsum("aq,cmqij->cmaij", _EXTRAPOLATION, inner)
            turns = part.turns[:, None, None]
            stress[part.elements] = turns @ nodal @ np.swapaxes(turns, -1, -2)
        return stress


def _trilinear(at: FloatArray) -> FloatArray:
    """Return the monomials of a trilinear function at points (n, 3), (n, 8)."""
    x, y, z = at.T
    return np.stack([np.ones_like(x), x, y, z, x * y, y * z, x * z, x * y * z], axis=1)


_EXTRAPOLATION = _trilinear(REFERENCE) @ np.linalg.inv(_trilinear(INNER))


def _sector_elements(gear: Toothing, section: QuadSector, sector: SweptSector) -> _SectorElements:
    """Place the bodies of a sector; the gear is right hand or spur, as the sector was made for."""
    axes, bodies = node_axes(gear, section), [batch for batch in sector.batches if not batch.seat]
    nodes, jacobian = np.empty((sector.bodies, 20, 3)), np.empty(sector.bodies)
    numbers, points = sector.elements[: sector.bodies].copy(), len(sector.freedoms)
    parts = []
    for batch in bodies:
        local, frames = placed_layer(section, batch, axes, twist(gear))
        middle = np.interp(
            sector.place[batch.elements[:, 0], 2], np.arange(len(sector.layers.ends)), sector.layers.ends
        )
        turns = np.stack([turn_about_axis(twist(gear) * float(z)) for z in middle])
        nodes[batch.elements] = np.einsum("cxy,mpy->cmpx", turns, local)
        nodes[batch.elements, :, 2] += middle[:, None, None]
        mesh, (inner, outer) = hexahedra(local), (0.5 * (at.T + 1.0) for at in (INNER, REFERENCE))
        volume = determinants(mesh, np.hstack([inner, outer]))
        jacobian[batch.elements] = volume.min(axis=1) / np.abs(volume).max(axis=1)
        parts.append(_Part(batch.elements, frames, gradients(mesh, inner), turns))
        if batch.half:
            hanging = (batch.elements.size, len(LOWER_FACE))
            own = points + np.arange(hanging[0] * hanging[1]).reshape(hanging)
            numbers[batch.elements.ravel()[:, None], LOWER_FACE] = own
            points += own.size
    angle = quad_quality(section.points, section.grid.quads).angle
    quality = {"scaled_jacobian": jacobian, "corner_angle_deg": np.empty(sector.bodies)}
    for batch in bodies:
        quality["corner_angle_deg"][batch.elements] = np.degrees(angle[batch.quads])
    lame = PlaneHypothesis.PLANE_STRAIN.lame_parameters(gear.material)
    return _SectorElements(nodes, numbers, points, quality, sector, lame, tuple(parts))


Load = Mapping[int, FloatArray]
# VTK's order of a hexahedron with bottom and top exchanged
UPSIDE_DOWN = [4, 5, 6, 7, 0, 1, 2, 3, 12, 13, 14, 15, 8, 9, 10, 11, 16, 17, 18, 19]


def deformed_solids(
    gear: Toothing,
    recipe: SectorRecipe,
    loads: Sequence[Load],
    beside: int = 1,
    *,
    seen_from_behind: bool = False,
) -> tuple[DeformedGear, ...]:
    """Solve for each set of loads; the gear is condensed once, which costs what its compliance costs.

    Raises `InputError`: a bore with a key: its sectors do not bend alike.

    Parameters
    ----------
    recipe
        As for `flank_compliance_3d`.
    loads : sequence of mapping
        Tooth number to nodal forces (nf,) along the outward normal, in the freedoms of `FlankCompliance3D`,
        N: a load presses with negative forces.
    beside : int
        How many unloaded teeth to show on either side of the loaded ones.
    seen_from_behind : bool
        The loads, and the flank displacements returned, are in the freedoms of the mirrored compliance, as
        the contact of a ring gear has them.
    """
    if gear.seat.key is not None:
        advice = "Leave the key out: under it every tooth bends in another way."
        raise InputError("seat.key", "given", "left out for deformed gears", advice)
    right = gear.right_handed()
    section = quad_sector(right, recipe)
    support = bore_support(right)
    left, mirror = gear.helix_angle < 0.0, None
    if left != seen_from_behind:
        planes = swept_sector(section.grid, gear.face_width, recipe, support, right.web).flank_index[::-1]
        mirror = planes[planes >= 0]
    sources = [(case, tooth) for case, load in enumerate(loads) for tooth in load]
    columns = np.stack([_mirrored_back(loads[case][tooth], mirror) for case, tooth in sources], axis=1)
    tooth, _ = condensed_tooth(right, section, recipe, support, StageClock())
    cuts = loaded_cuts(tooth.held, columns, right.teeth)
    solved = CondensedGear(*tooth, RingSolution(np.empty((0, 0, 0)), cuts.everywhere))
    elements = _sector_elements(right, section, solved.sector)
    deformed = []
    for case in range(len(loads)):
        own = [i for i, (number, _) in enumerate(sources) if number == case]
        loaded = _Loaded(np.array([sources[i][1] for i in own]), np.array(own), columns[:, own])
        deformed.append(_deformed(gear.teeth, solved, elements, loaded, beside, mirror, left))
    return tuple(deformed)


@dataclass(frozen=True)
class _Loaded:
    """Loaded teeth of one case: their numbers, their columns among the probe loads, and the loads (nf, p)."""

    teeth: IntArray
    columns: IntArray
    forces: FloatArray


def _mirrored_back(values: FloatArray, mirror: IntArray | None) -> FloatArray:
    """Return flank values in the numbering of the gear's mirror image."""
    if mirror is None:
        return values
    back = np.empty_like(values)
    back[mirror] = values
    return back


def _shown(loaded: IntArray, beside: int, teeth: int) -> IntArray:
    """Return consecutive tooth numbers from the first to the last loaded one and beside them, at most all."""
    shown = np.arange(loaded.min() - beside, loaded.max() + beside + 1)
    return shown if len(shown) <= teeth else np.arange(teeth) - (teeth - 1) // 2


def _fields(gear: CondensedGear, loaded: _Loaded, shown: IntArray) -> tuple[FloatArray, FloatArray]:
    """Return all freedoms (n, T) and the flank loads (nf, T) of the teeth `shown`."""
    left = gear.ring.left
    size, teeth = gear.held.cut_size, len(left)
    cuts = np.zeros((2 * size, len(shown)))
    forces = np.zeros((len(loaded.forces), len(shown)))
    for tooth, column, force in zip(loaded.teeth, loaded.columns, loaded.forces.T, strict=True):
        apart = shown - tooth
        cuts[:size] += left[apart % teeth, :, column].T
        cuts[size:] += left[(apart - 1) % teeth, :, column].T
        forces[:, apart % teeth == 0] += force[:, None]
    flank = gear.held.flank @ forces + gear.held.transmitted.T @ cuts
    return gear.condensation.expand(np.concatenate([flank, cuts])), forces


def _deformed(
    teeth: int,
    gear: CondensedGear,
    elements: _SectorElements,
    loaded: _Loaded,
    beside: int,
    mirror: IntArray | None,
    left: bool,
) -> DeformedGear:
    shown = _shown(loaded.teeth, beside, teeth)
    fields, forces = _fields(gear, loaded, shown)
    closed = len(shown) == teeth
    numbers = _numbers(gear.sector, elements, len(shown), closed)
    count = int(numbers.max()) + 1
    points, displacement = np.empty((count, 3)), np.empty((count, 3))
    stress = np.empty((*numbers.shape, 3, 3))
    for i, tooth in enumerate(shown):
        turn = turn_about_axis(2.0 * math.pi * tooth / teeth)
        moved = elements.displacement(fields[:, i])
        points[numbers[i]] = elements.nodes @ turn.T
        displacement[numbers[i]] = moved @ turn.T
        stress[i] = turn @ elements.stress(moved) @ turn.T
    cells = numbers.reshape(-1, numbers.shape[-1])
    mean = nodal_mean(cells, stress.reshape(-1, *stress.shape[2:]), count)
    flip = np.array([1.0, 1.0, -1.0 if left else 1.0])
    flank = fields[gear.sector.flank]
    return DeformedGear(
        points=points * flip,
        cells=cells[:, UPSIDE_DOWN] if left else cells,
        tooth=np.repeat(shown, len(elements.nodes)),
        displacement=displacement * flip,
        stress=mean * np.outer(flip, flip),
        quality={name: np.tile(values, len(shown)) for name, values in elements.quality.items()},
        flank_displacement={
            int(tooth): flank[:, i] if mirror is None else flank[mirror, i] for i, tooth in enumerate(shown)
        },
        residual=_residual(gear, fields, forces, closed),
    )


def _numbers(sector: SweptSector, elements: _SectorElements, count: int, closed: bool) -> IntArray:
    """Return the point of every element node, (T, e, 20); a left cut is the next sector's right cut."""
    each = elements.points
    numbers = np.arange(count * each).reshape(count, each)
    left, right = (sector.nodes[:, column] for column in (sector.grid.left, sector.grid.right))
    left, right = left[left >= 0], right[right >= 0]
    following = range(count) if closed else range(count - 1)
    for i in following:
        numbers[i, left] = numbers[(i + 1) % count, right]
    _, packed = np.unique(numbers, return_inverse=True)
    return np.asarray(packed.reshape(count, each)[:, elements.numbers])


def _residual(gear: CondensedGear, fields: FloatArray, forces: FloatArray, closed: bool) -> float:
    """Return the norm of f - K u over that of f; on cuts between two sectors both of them count."""
    sector = gear.sector
    free = sector.element_freedoms >= 0
    out = np.empty_like(fields)
    for i in range(fields.shape[1]):
        inside = element_forces(sector, gear.stiffness, fields[:, i])
        out[:, i] = -np.bincount(sector.element_freedoms[free], inside[free], minlength=sector.size)
    out[sector.flank] += forces
    meeting = out[sector.left] + np.roll(out[sector.right], -1, axis=1)
    if not closed:
        meeting = meeting[:, :-1]
    out[sector.left] = out[sector.right] = 0.0
    norm = math.hypot(float(np.linalg.norm(out)), float(np.linalg.norm(meeting)))
    return norm / float(np.linalg.norm(forces))
