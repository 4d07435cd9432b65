"""Tooth sectors of a gear of finite width under flank loads on several teeth, expanded from their flanks.

A *sector* is the part of the gear with one tooth between two *cuts* in the middles of the tooth spaces. The
ring of sectors is solved for every loaded tooth as if that were tooth 0; the numbers of the teeth are then
shifted. The inside of a sector follows from its flank and both cuts (`Condensation.expand`). A left-handed
gear is computed as its mirror image, which is right-handed. Sizes: nf flank freedoms, p loaded teeth of a
case, T teeth in view, n freedoms of a sector.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from fe_contact.compliance.condensed_gear import CondensedGear, condensed_tooth
from fe_contact.compliance.cyclic_ring import RingSolution, loaded_cuts
from fe_contact.compliance.deformed_gear import DeformedGear, nodal_mean, turn_about_axis
from fe_contact.compliance.gear_checks import element_forces
from fe_contact.compliance.sector_elements import SectorElements, sector_elements
from fe_contact.errors import InputError
from fe_contact.geometry import Toothing
from fe_contact.mesh.bore_support import bore_support
from fe_contact.mesh.quad_sector import quad_sector
from fe_contact.mesh.sector_recipe import SectorRecipe
from fe_contact.mesh.swept_sector import SweptSector, swept_sector
from fe_contact.types import FloatArray, IntArray
from model_studies.stage_clock import StageClock

Load = Mapping[int, FloatArray]
"""Number of a tooth to its nodal forces (nf,), N."""
# VTK's order of the 20 nodes of a hexahedron with bottom and top exchanged, for mirror images
UPSIDE_DOWN = [4, 5, 6, 7, 0, 1, 2, 3, 12, 13, 14, 15, 8, 9, 10, 11, 16, 17, 18, 19]


def deformed_solids(
    gear: Toothing,
    recipe: SectorRecipe,
    loads: Sequence[Load],
    unloaded: int = 1,
    *,
    seen_from_behind: bool = False,
) -> tuple[DeformedGear, ...]:
    """Return the deformed gear under each set of loads.

    The gear is condensed once, at the cost of computing its compliance. Raises `InputError`: a bore with a
    key, whose sectors do not bend alike.

    Parameters
    ----------
    recipe
        As for `flank_compliance_3d`.
    loads : sequence of mapping
        Tooth number to nodal forces (nf,) along the outward normal, in the freedoms of `FlankCompliance3D`,
        N: a load presses with negative forces.
    unloaded : int
        Number of unloaded teeth to show on either side of the loaded ones.
    seen_from_behind : bool
        Whether loads and returned flank displacements are in the freedoms of the mirrored compliance, as in
        the contact of a ring gear.
    """
    if gear.seat.key is not None:
        remedy = "Leave the key out: under it every tooth bends in another way."
        raise InputError("seat.key", "given", "left out for deformed gears", remedy)
    right = gear.right_handed()
    section = quad_sector(right, recipe)
    support = bore_support(right)
    left, mirror = gear.helix_angle < 0.0, None
    if left != seen_from_behind:  # the mirror image of a mirror image needs none
        # freedoms of the planes across the face from the other end on; -1 at centers of faces
        planes = swept_sector(section.grid, gear.face_width, recipe, support, right.web).flank_index[::-1]
        mirror = planes[planes >= 0]
    # a column for each tooth of each case
    columns = np.stack([_mirrored_back(force, mirror) for load in loads for force in load.values()], axis=1)
    tooth, _ = condensed_tooth(right, section, recipe, support, StageClock())
    cuts = loaded_cuts(tooth.condensed, columns, right.teeth)
    # the deformed gear needs the cuts of the ring, but no compliance blocks
    solved = CondensedGear(*tooth, ring=RingSolution(blocks=np.empty((0, 0, 0)), left=cuts.everywhere))
    elements = sector_elements(right, section, solved.sector)
    deformed = []
    start = 0  # column of the case's first tooth
    for load in loads:
        members = np.arange(start, start + len(load))
        start += len(load)
        loaded = _Loaded(np.array(list(load)), members, columns[:, members])
        deformed.append(_deformed_gear(gear.teeth, solved, elements, loaded, unloaded, mirror, left))
    return tuple(deformed)


@dataclass(frozen=True)
class _Loaded:
    """The p loaded teeth of one case."""

    teeth: IntArray
    """Numbers of the teeth. Shape (p,)."""
    columns: IntArray
    """Columns of the teeth among the loads of all cases. Shape (p,)."""
    forces: FloatArray
    """Forces on the flanks, N. Shape (nf, p)."""


def _mirrored_back(values: FloatArray, mirror: IntArray | None) -> FloatArray:
    """Return flank values in the numbering of the gear's mirror image; unchanged without a `mirror`."""
    if mirror is None:
        return values
    back = np.empty_like(values)
    back[mirror] = values
    return back


def _teeth_in_view(loaded: IntArray, unloaded: int, teeth: int) -> IntArray:
    """Return consecutive tooth numbers: loaded teeth with `unloaded` ones on either side, at most all."""
    teeth_in_view = np.arange(loaded.min() - unloaded, loaded.max() + unloaded + 1)
    return teeth_in_view if len(teeth_in_view) <= teeth else np.arange(teeth) - (teeth - 1) // 2


def _fields(gear: CondensedGear, loaded: _Loaded, view: IntArray) -> tuple[FloatArray, FloatArray]:
    """Return all freedoms (n, T) and the flank loads (nf, T) of the teeth `view`."""
    left = gear.ring.left
    size, teeth = gear.condensed.cut_size, len(left)
    cuts = np.zeros((2 * size, len(view)))
    forces = np.zeros((len(loaded.forces), len(view)))
    for tooth, column, force in zip(loaded.teeth, loaded.columns, loaded.forces.T, strict=True):
        distance = view - tooth
        cuts[:size] += left[distance % teeth, :, column].T
        cuts[size:] += left[(distance - 1) % teeth, :, column].T
        forces[:, distance % teeth == 0] += force[:, None]
    flank = gear.condensed.flank @ forces + gear.condensed.transmitted.T @ cuts  # by forces, and by the cuts
    return gear.condensation.expand(np.concatenate([flank, cuts])), forces


def _deformed_gear(
    teeth: int,
    gear: CondensedGear,
    elements: SectorElements,
    loaded: _Loaded,
    unloaded: int,
    mirror: IntArray | None,
    left: bool,
) -> DeformedGear:
    """Return the gear under the loads of one case; a `left` gear is the mirror image of what was solved."""
    view = _teeth_in_view(loaded.teeth, unloaded, teeth)
    fields, forces = _fields(gear, loaded, view)
    closed = len(view) == teeth
    numbers = _numbers(gear.sector, elements, len(view), closed)
    count = int(numbers.max()) + 1
    points, displacement = np.empty((count, 3)), np.empty((count, 3))
    stress = np.empty((*numbers.shape, 3, 3))
    for i, tooth in enumerate(view):
        rotation_matrix = turn_about_axis(2.0 * math.pi * tooth / teeth)
        motion = elements.displacement(fields[:, i])
        points[numbers[i]] = elements.nodes @ rotation_matrix.T
        displacement[numbers[i]] = motion @ rotation_matrix.T
        stress[i] = rotation_matrix @ elements.stress(motion) @ rotation_matrix.T
    cells = numbers.reshape(-1, numbers.shape[-1])
    mean = nodal_mean(cells, stress.reshape(-1, *stress.shape[2:]), count)
    flip = np.array([1.0, 1.0, -1.0 if left else 1.0])  # mirrored in the plane z = 0
    flank = fields[gear.sector.flank]
    return DeformedGear(
        points=points * flip,
        cells=cells[:, UPSIDE_DOWN] if left else cells,
        tooth=np.repeat(view, len(elements.nodes)),  # one entry per element
        displacement=displacement * flip,
        stress=mean * np.outer(flip, flip),
        quality={name: np.tile(values, len(view)) for name, values in elements.quality.items()},
        flank_displacement={
            int(tooth): flank[:, i] if mirror is None else flank[mirror, i] for i, tooth in enumerate(view)
        },
        residual=_residual(gear, fields, forces, closed),
    )


def _numbers(sector: SweptSector, elements: SectorElements, count: int, closed: bool) -> IntArray:
    """Return the point of every element node, (T, e, 20); a left cut is the next sector's right cut."""
    points_of_tooth = elements.points
    numbers = np.arange(count * points_of_tooth).reshape(count, points_of_tooth)
    left, right = (sector.nodes[:, column] for column in (sector.grid.left, sector.grid.right))
    left, right = left[left >= 0], right[right >= 0]
    following = range(count) if closed else range(count - 1)
    for i in following:
        numbers[i, left] = numbers[(i + 1) % count, right]
    _, packed = np.unique(numbers, return_inverse=True)
    return np.asarray(packed.reshape(count, points_of_tooth)[:, elements.numbers])


def _residual(gear: CondensedGear, fields: FloatArray, forces: FloatArray, closed: bool) -> float:
    """Return the norm of f - K u over that of f; forces on a cut are the sum of those of both sectors."""
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
