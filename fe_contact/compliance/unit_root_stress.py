"""Unit-load stress of the tooth roots of a gear, in the plane or over the face, with its cache.

Mesh and hypotheses are those of the flank compliances. The stress is computed on request only.

In the plane, with the stiffness K of the sector split into interior i and boundary b, the forces N q on the
flank, and R the rows that give stresses by displacements u,

    sigma = R_i u_i + R_b u_b = (N' X)' q + (R_b - X' K_ib) u_b,    X = K_ii^-1 R_i',

so a stress costs one right-hand side for any number of forces. Over the face see `root_stress_3d`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from fe_contact.compliance.cache import cached_or_computed, cached_size, computed_once, content_hash
from fe_contact.compliance.condensed_sector import freedoms
from fe_contact.compliance.cyclic_compliance import compliance_key_3d
from fe_contact.compliance.factorization import FACTORIZATION
from fe_contact.compliance.flank_compliance_2d import (
    compliance_key,
    condensed_ring,
    condensed_teeth,
    section_keys,
    tooth_indices,
)
from fe_contact.compliance.plane_hypothesis import PlaneHypothesis
from fe_contact.compliance.ring_2d import Ring
from fe_contact.compliance.ring_checks import field_under, uniform_pressure
from fe_contact.compliance.root_stress import (
    RootStressChecks,
    UnitRootStress,
    refuse_broken_stress,
    relative_difference,
)
from fe_contact.compliance.root_surface import (
    COMPONENTS,
    STATIONS,
    RootSurface,
    between_nodes,
    root_coordinate,
)
from fe_contact.compliance.tooth_reach import usual_reach
from fe_contact.errors import InputError
from fe_contact.geometry import Toothing, tooth_profile
from fe_contact.geometry.flank_profile import FlankProfile
from fe_contact.geometry.root_tangent import tangent_angle
from fe_contact.material import Material
from fe_contact.mesh import MeshRecipe, SectorRecipe, mesh_gear
from fe_contact.mesh.bore_support import BoreSupport, bore_support
from fe_contact.mesh.quadratic_mesh import SIDES
from fe_contact.mesh.tooth_sector import ToothSector
from fe_contact.types import FloatArray, IntArray
from host.optional_modules import sparse as sp
from model_studies.stage_clock import StageClock

MODEL_VERSION = 1  # raise it whenever the same input gives another result: old cache files are then not found


def unit_root_stress(
    gear: Toothing,
    recipe: MeshRecipe | None = None,
    hypothesis: PlaneHypothesis = PlaneHypothesis.PLANE_STRAIN,
    *,
    teeth: int | None = None,
    cache: Path | None = None,
) -> UnitRootStress:
    """Return the unit-load root stress of the transverse section; parameters are those of `flank_compliance`.

    Raises
    ------
    InputError
        `teeth` is even or exceeds the real teeth.
    MeshError
        No acceptable mesh.
    SolveError
        The matrix is singular, or the result breaks a law.
    """
    recipe = recipe or MeshRecipe.standard(gear)
    count = condensed_teeth(gear, recipe, teeth)
    key = compliance_key(gear, recipe, hypothesis, count)
    return _cached_stress(key, lambda: _compute_in_plane(gear, recipe, hypothesis, count), cache)


def unit_root_stress_3d(
    gear: Toothing,
    recipe: SectorRecipe | None = None,
    *,
    reach: int | None = None,
    support: BoreSupport | None = None,
    cache: Path | None = None,
) -> UnitRootStress:
    """Return the unit-load root stress over the face; parameters are those of `flank_compliance_3d`.

    Gears of opposite hand are mirror images to the last bit: the left-hand one is made from the other. Raises
    `MeshError`: no acceptable mesh; `SolveError`: the stiffness is singular, or the result breaks a law.
    """
    recipe, support = recipe or SectorRecipe.standard(gear), support or bore_support(gear.right_handed())
    distance = usual_reach(gear) if reach is None else reach
    if gear.seat.key is not None:  # only what is the same at every tooth can be computed
        raise InputError("seat.key", "given", "left out for root stress", "Leave the key out for it.")

    def compute() -> UnitRootStress:
        # A cached result needs no numba.
        from fe_contact.compliance.root_stress_3d import compute_root_stress_3d  # noqa: PLC0415

        return compute_root_stress_3d(gear.right_handed(), recipe, distance, support)

    stress = _cached_stress(compliance_key_3d(gear, recipe, distance, support), compute, cache)
    return stress.mirrored() if gear.helix_angle < 0.0 else stress


def unit_root_stresses(
    gears: Sequence[Toothing],
    recipes: Sequence[MeshRecipe],
    hypothesis: PlaneHypothesis,
    *,
    teeth: int | None = None,
    cache: Path | None = None,
) -> tuple[UnitRootStress, ...]:
    """Return the root stress of each gear; gears of one section, material and recipe are computed once."""
    return computed_once(
        section_keys(gears, recipes, hypothesis, teeth),
        lambda i: unit_root_stress(gears[i], recipes[i], hypothesis, teeth=teeth, cache=cache),
    )


def unit_root_stresses_3d(
    gears: Sequence[Toothing], recipes: Sequence[SectorRecipe], *, cache: Path | None = None
) -> tuple[UnitRootStress, ...]:
    """Return the root stress of each gear; gears alike, or alike but for the hand, are computed once."""
    right_hand = [gear.right_handed() for gear in gears]
    keys = [
        compliance_key_3d(gear, recipe, usual_reach(gear), bore_support(gear))
        for gear, recipe in zip(right_hand, recipes, strict=True)
    ]
    stresses = computed_once(keys, lambda i: unit_root_stress_3d(right_hand[i], recipes[i], cache=cache))
    return tuple(
        stress.mirrored() if gear.helix_angle < 0.0 else stress
        for gear, stress in zip(gears, stresses, strict=True)
    )


def stress_cached(
    gear: Toothing, recipe: MeshRecipe | SectorRecipe, hypothesis: PlaneHypothesis, cache: Path | None
) -> bool:
    """Whether the unit-load root stress of a gear is in the cache; solids have no use of the hypothesis."""
    if isinstance(recipe, SectorRecipe):
        right = gear.right_handed()
        key = compliance_key_3d(right, recipe, usual_reach(right), bore_support(right))
    else:
        key = compliance_key(gear, recipe, hypothesis, condensed_teeth(gear, recipe, None))
    return bool(cached_size(cache, _stress_key(key)))


def _stress_key(compliance: str) -> str:
    return content_hash({"root stress": MODEL_VERSION, "compliance": compliance})


def _cached_stress(
    compliance: str, compute: Callable[[], UnitRootStress], cache: Path | None
) -> UnitRootStress:
    return cached_or_computed(cache, _stress_key(compliance), UnitRootStress, compute)


def _compute_in_plane(
    gear: Toothing, recipe: MeshRecipe, hypothesis: PlaneHypothesis, teeth: int
) -> UnitRootStress:
    clock = StageClock()
    mesh, profile = mesh_gear(gear, recipe), tooth_profile(gear)
    root = triangle_root(mesh.sector, profile)
    clock.finish("mesh")
    ring = condensed_ring(gear, mesh, hypothesis)
    clock.finish("factorisation")
    rows = [edge_stress(mesh.sector.points, chain, gear.material, hypothesis) for chain in root.nodes]
    functionals = sp.csr_array(sp.vstack(rows))
    loaded_tooth, index = tooth_indices(mesh, 1), tooth_indices(mesh, teeth)
    stress = _unit_load_stress(ring, functionals, int(loaded_tooth[0]), index)
    clock.finish("stress")
    forces = uniform_pressure(mesh.sector.s, profile.s_form, gear.base_radius).forces
    checks = _checks_in_plane(ring, functionals, int(loaded_tooth[0]), forces, stress[teeth // 2])
    clock.finish("checks")
    stations = between_nodes(root.s)
    count = mesh.sector.s.size
    return refuse_broken_stress(
        UnitRootStress(
            distance=np.arange(teeth) - teeth // 2,
            stress=stress.reshape(teeth, 2, COMPONENTS, stations.size, 1, count),
            station_s=stations,
            station_z=np.zeros(1),
            tangent_angle=tangent_angle(profile, stations),
            s=mesh.sector.s,
            z=np.empty(0),
            index=np.arange(count)[None],
            checks=checks,
            unknowns=2 * (len(mesh.points) - len(mesh.bore_nodes)),
            seconds=clock.seconds,
            solver=FACTORIZATION,
        )
    )


def _unit_load_stress(ring: Ring, functionals: sp.csr_array, tooth: int, index: IntArray) -> FloatArray:
    """Return the stresses (t, r, k) of tooth `tooth` under unit forces on each of t teeth.

    They are in the order in which `tooth` is -t // 2 to t // 2 teeth ahead of the loaded one.
    """
    sector = ring.sector
    inner, border = sector.interior, freedoms(sector.boundary)
    by_row = sector.solve(functionals[:, inner].T.toarray())
    local = np.asarray((sector.loads[inner].T @ by_row).T)
    on_border = functionals[:, border].toarray() - (sector.matrix[border][:, inner] @ by_row).T
    right = np.zeros((ring.matrix.shape[0], len(on_border)))
    right[ring.rows(tooth)] = ring.turned(tooth, on_border.T)
    shared = ring.solve(right)
    # `tooth` is n ahead of tooth - n; `index` holds tooth + n for increasing n
    loaded = 2 * tooth - index
    stress = np.stack([shared[ring.rows(int(i))].T @ ring.turned(int(i), sector.transmitted) for i in loaded])
    stress[len(index) // 2] += local
    return stress


def _checks_in_plane(
    ring: Ring, functionals: sp.csr_array, tooth: int, forces: FloatArray, stress: FloatArray
) -> RootStressChecks:
    """Compare with the displacement of the whole mesh under `forces` (k,) on tooth `tooth`."""
    mesh = ring.mesh
    field = field_under(ring, tooth, forces)
    out_of_balance = field.load - field.internal
    out_of_balance[mesh.bore_nodes] = 0.0
    direct = functionals @ field.displacement[mesh.sector_nodes[tooth]].ravel()
    return RootStressChecks(
        residual=float(np.linalg.norm(out_of_balance) / np.linalg.norm(field.load)),
        recovery=relative_difference(stress @ forces, direct),
    )


def triangle_root(sector: ToothSector, profile: FlankProfile) -> RootSurface:
    """Return the root of a sector of six-node triangles; it is found by walking along the boundary."""
    form = int(np.argmin(np.abs(sector.s[::2] - profile.s_form)))
    edges = np.concatenate([sector.triangles[:, [*side, 3 + i]] for i, side in enumerate(SIDES)])
    ends = np.sort(edges[:, :2], axis=1)
    _, first, count = np.unique(ends, axis=0, return_index=True, return_counts=True)
    ahead = {int(a): (int(middle), int(b)) for a, b, middle in edges[first[count == 1]]}
    back = {after: (middle, before) for before, (middle, after) in ahead.items()}
    if profile.gear.sign < 0:  # teeth that point inwards
        ahead, back = back, ahead
    right = _walk(ahead, int(sector.right_side[-1]), int(sector.flank[2 * form]))
    left = _walk(back, int(sector.left_side[-1]), int(sector.coast_flank[2 * form]))
    return RootSurface(np.array([right, left]), root_coordinate(profile, sector.points[right]))


def _walk(following: dict[int, tuple[int, int]], start: int, stop: int) -> list[int]:
    """Return the nodes from one corner of the boundary to another."""
    nodes = [start]
    while nodes[-1] != stop:
        nodes += following[nodes[-1]]
    return nodes


def edge_stress(
    points: FloatArray, nodes: IntArray, material: Material, hypothesis: PlaneHypothesis
) -> sp.csr_array:
    """Return the stresses of a chain of quadratic edges by displacements of a plane mesh, (3 * 2e, 2n), Pa/m.

    The chain is of `nodes` (2e + 1,) of `points` (n, 2). All stations of one component stand together.
    There is no shear between profile and axis.
    """
    edges = np.stack([nodes[:-2:2], nodes[1::2], nodes[2::2]], axis=1)
    slopes = np.stack([STATIONS - 0.5, -2.0 * STATIONS, STATIONS + 0.5], axis=1)
    along = slopes @ points[edges]  # (e, 2 stations, 2)
    length = np.linalg.norm(along, axis=2)[:, :, None, None]
    strain = slopes[:, :, None] * along[:, :, None, :] / length**2  # (e, station, node, component)
    freedoms = np.broadcast_to(2 * edges[:, None, :, None] + np.arange(2), strain.shape)
    rows = np.broadcast_to(np.arange(2 * len(edges)).reshape(-1, 2, 1, 1), strain.shape)
    shape = (2 * len(edges), 2 * len(points))
    profile = hypothesis.contact_modulus(material) * sp.csr_array(
        (strain.ravel(), (rows.ravel(), freedoms.ravel())), shape=shape
    )
    lateral = material.poissons_ratio if hypothesis is PlaneHypothesis.PLANE_STRAIN else 0.0
    return sp.csr_array(sp.vstack([profile, lateral * profile, sp.csr_array(shape)]))
