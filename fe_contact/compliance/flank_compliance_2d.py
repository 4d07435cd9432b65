"""From a gear to its flank compliance in the transverse plane: mesh, assemble, condense, check."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np
import scipy.sparse as sp
from scipy.linalg import eigh

from fe_contact.compliance.cache import (
    KEPT_KEYS,
    content_hash,
    kept_or_computed,
    mesher_version,
    once_each,
)
from fe_contact.compliance.condensed_sector import condense_sector
from fe_contact.compliance.factorization import FACTORIZATION
from fe_contact.compliance.flank import (
    ComplianceChecks,
    FlankCompliance,
    left_by_rounding,
    refuse_broken_laws,
)
from fe_contact.compliance.plane_elasticity import stiffness_matrix
from fe_contact.compliance.plane_hypothesis import PlaneHypothesis
from fe_contact.compliance.ring_2d import Ring, assemble_ring, flank_matrices, rotation
from fe_contact.errors import InputError, integer
from fe_contact.geometry import Toothing, tooth_profile
from fe_contact.mesh import GearMesh, MeshRecipe, mesh_gear
from fe_contact.types import FloatArray, IntArray, Json
from model_studies.stage_clock import StageClock

# Checks of a condensed gear on its uncondensed mesh, by the field of one load.

MODEL_VERSION = 5  # raise it whenever the same input gives another result: old cache files are then not found
USUAL_TEETH = 5


@dataclass(frozen=True)
class Field:
    """Displacement of the whole mesh under a flank load on one tooth, per unit face width."""

    displacement: FloatArray
    """m per N/m of load. Shape (N, 2)."""
    load: FloatArray
    internal: FloatArray
    """`load`, `internal`: Applied nodal forces and K u, N/m. Shape (N, 2) each."""


@dataclass(frozen=True)
class _FlankLoad:
    """Inward normal forces on the involute of one tooth."""

    forces: FloatArray
    """At the flank's nodes, N/m. Shape (k,)."""
    moment: float
    """Their moment about the gear's axis, N: every normal of an involute touches the base circle."""

    def work(self, matrix: FloatArray) -> float:
        """Return q' S q with S the middle diagonal block of a flank compliance."""
        k = len(self.forces)
        start = (len(matrix) // k - 1) // 2 * k
        return float(self.forces @ matrix[start : start + k, start : start + k] @ self.forces)


def uniform_pressure(s: FloatArray, s_form: float, base_radius: float) -> _FlankLoad:
    """Return the load of unit pressure on the involute.

    `s` (k,) are the flank's nodes; elements that begin below `s_form` carry nothing, since their normals
    miss the base circle.
    """
    lengths = np.where(s[:-2:2] >= s_form, s[2::2] - s[:-2:2], 0.0)
    forces = np.zeros(len(s))
    forces[:-2:2] += lengths / 6.0
    forces[1::2] = 4.0 * lengths / 6.0
    forces[2::2] += lengths / 6.0
    return _FlankLoad(forces, base_radius * float(forces.sum()))


def field_under(ring: Ring, tooth_index: int, forces: FloatArray) -> Field:
    """Solve for the whole mesh under inward normal `forces` (k,) on one tooth, and apply its stiffness."""
    mesh, sector = ring.mesh, ring.sector
    right = np.zeros((ring.matrix.shape[0], 1))
    right[ring.rows(tooth_index)] = ring.turned(tooth_index, (sector.transmitted @ forces)[:, None])
    free = ring.position >= 0
    shared = np.zeros(2 * len(mesh.points))
    shared[free] = ring.solve(right)[ring.position[free], 0]
    u = shared.reshape(-1, 2)
    local_load = np.zeros((sector.matrix.shape[0], len(mesh.teeth)))
    local_load[:, tooth_index] = sector.loads @ forces
    local = _recovered(ring, u, local_load)
    load, internal = np.zeros_like(u), np.zeros_like(u)
    forces_in = sector.matrix @ local
    for i, j in enumerate(mesh.teeth):
        turn, nodes = rotation(j * mesh.pitch_angle).T, mesh.sector_nodes[i]
        u[nodes] = local[:, i].reshape(-1, 2) @ turn
        internal[nodes] += forces_in[:, i].reshape(-1, 2) @ turn
        load[nodes] += local_load[:, i].reshape(-1, 2) @ turn
    if ring.hub_matrix is not None:
        internal[mesh.hub_nodes] += (ring.hub_matrix @ u[mesh.hub_nodes].ravel()).reshape(-1, 2)
    return Field(u, load, internal)


def _stiffness_alone(ring: Ring) -> FloatArray:
    """Return the stiffness (N,) in Pa of each node with all others held, along its stiffer axis."""
    mesh = ring.mesh
    stiffness, sector_entries = np.zeros(len(mesh.points)), _larger(ring.sector.matrix)
    for nodes in mesh.sector_nodes:
        stiffness[nodes] += sector_entries
    if ring.hub_matrix is not None:
        stiffness[mesh.hub_nodes] += _larger(ring.hub_matrix)
    return stiffness


def _larger(matrix: sp.csc_array) -> FloatArray:
    """Return the larger diagonal entry of each node, (n,)."""
    return np.asarray(matrix.diagonal().reshape(-1, 2).max(axis=1))


def _recovered(ring: Ring, u: FloatArray, load: FloatArray) -> FloatArray:
    """Return the displacement of every sector in its tooth frame (2n, t) from that of the shared nodes."""
    mesh, sector = ring.mesh, ring.sector
    local = np.zeros_like(load)
    for i, j in enumerate(mesh.teeth):
        local[:, i] = (u[mesh.sector_nodes[i]] @ rotation(j * mesh.pitch_angle)).ravel()
    local[sector.interior] = 0.0
    inner = sector.interior
    local[inner] = sector.solve((load - sector.matrix @ local)[inner])
    return local


def _ring_checks(ring: Ring, tooth_index: int, load: _FlankLoad, matrix: FloatArray) -> ComplianceChecks:
    """Check the compliance of a ring under a load on the tooth of an index.

    `matrix` is the flank compliance as computed, before it is made symmetric; the loaded tooth is the
    middle one.
    """
    field = field_under(ring, tooth_index, load.forces)
    bore = ring.mesh.bore_nodes
    out_of_balance = field.load - field.internal
    reaction = -out_of_balance[bore]
    out_of_balance[bore] = 0.0
    x, y = ring.mesh.points[bore].T
    moment = float(np.sum(x * reaction[:, 1] - y * reaction[:, 0]))
    works = [float(np.sum(field.displacement * forces)) for forces in (field.internal, field.load)]
    works.append(load.work(matrix))
    stiffness = np.repeat(_stiffness_alone(ring), 2)
    left = left_by_rounding(stiffness, field.displacement.ravel(), field.load, works[0])
    return ComplianceChecks(
        residual=float(np.linalg.norm(out_of_balance) / np.linalg.norm(field.load)),
        reciprocity=float(np.abs(matrix - matrix.T).max() / np.abs(matrix).max()),
        bore_moment=abs(moment + load.moment) / load.moment,
        energy=float(np.ptp(works) / works[0]),
        least_eigenvalue=float(eigh(matrix, subset_by_index=[0, 0], eigvals_only=True)[0]),
        residual_rounding=left[0],
        energy_rounding=left[1],
    )


def flank_compliance(
    gear: Toothing,
    recipe: MeshRecipe | None = None,
    hypothesis: PlaneHypothesis = PlaneHypothesis.PLANE_STRAIN,
    *,
    teeth: int | None = None,
    cache: Path | None = None,
) -> FlankCompliance:
    """Return the compliance of the right flanks of a gear, transverse section, per unit face width.

    Parameters
    ----------
    gear : Gear
        Modification plays no part, and face width only beside the thickness of a web: its elements are as
        much thinner than the others (`docs/effects.md#thin_rim`).
    recipe : MeshRecipe, optional
        Default `MeshRecipe.standard(gear)`.
    teeth : int, optional
        Number of condensed teeth, odd, centered on tooth 0, at most the real ones; default 5, or as many as
        there are.
    cache : Path, optional
        Directory of kept results (see `default_cache_directory`); None: neither read nor written.

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
    return kept_or_computed(
        cache, key, FlankCompliance, lambda: compute_flank_compliance(gear, recipe, hypothesis, count)
    )


def flank_compliances(
    gears: Sequence[Toothing],
    recipes: Sequence[MeshRecipe] | None = None,
    hypothesis: PlaneHypothesis = PlaneHypothesis.PLANE_STRAIN,
    *,
    teeth: int | None = None,
    cache: Path | None = None,
) -> tuple[FlankCompliance, ...]:
    """Return the compliance of each gear; gears of the same section, material and recipe share one object.

    Parameters are those of `flank_compliance`, with one recipe per gear.
    """
    recipes = recipes or [MeshRecipe.standard(gear) for gear in gears]
    keys = section_keys(gears, recipes, hypothesis, teeth)
    return once_each(
        keys, lambda i: flank_compliance(gears[i], recipes[i], hypothesis, teeth=teeth, cache=cache)
    )


def section_keys(
    gears: Sequence[Toothing], recipes: Sequence[MeshRecipe], hypothesis: PlaneHypothesis, teeth: int | None
) -> list[str]:
    """Return the `compliance_key` of each gear."""
    return [
        compliance_key(gear, recipe, hypothesis, condensed_teeth(gear, recipe, teeth))
        for gear, recipe in zip(gears, recipes, strict=True)
    ]


def condensed_teeth(gear: Toothing, recipe: MeshRecipe, teeth: int | None) -> int:
    """Return the number of condensed teeth, checked against the real ones."""
    real = min(gear.teeth, recipe.real_teeth or gear.teeth)
    limit = real - 1 + real % 2
    if teeth is None:
        return min(USUAL_TEETH, limit)
    count = integer("teeth", teeth, 1, limit, "Condensed teeth must be real ones; see MeshRecipe.real_teeth.")
    if count % 2 == 0:
        raise InputError("teeth", teeth, "odd", "The teeth are centered on tooth 0.")
    return count


def compliance_key(gear: Toothing, recipe: MeshRecipe, hypothesis: PlaneHypothesis, teeth: int) -> str:
    """Return the hash of all that decides a compliance of the transverse section."""
    return _key(gear, recipe, hypothesis, teeth, MODEL_VERSION)


@lru_cache(maxsize=KEPT_KEYS)
def _key(gear: Toothing, recipe: MeshRecipe, hypothesis: PlaneHypothesis, teeth: int, version: int) -> str:
    """Hash them once: predictions ask for the same few keys again and again."""
    section = gear.macro_geometry()
    if gear.web is None:
        section.pop("face_width")
    content: Json = {
        "model": ["transverse section", version],
        "gmsh": mesher_version(),
        "section": section,
        "material": [gear.material.youngs_modulus, gear.material.poissons_ratio],
        "recipe": recipe.content(),
        "hypothesis": hypothesis.value,
        "teeth": teeth,
        "solver": FACTORIZATION,
    }
    return content_hash(content)


def compute_flank_compliance(
    gear: Toothing, recipe: MeshRecipe, hypothesis: PlaneHypothesis, teeth: int
) -> FlankCompliance:
    """Mesh, assemble, condense and check; no cache."""
    clock = StageClock()
    mesh = mesh_gear(gear, recipe)
    clock.finish("mesh")
    ring = condensed_ring(gear, mesh, hypothesis)
    clock.finish("factorisation")
    index = tooth_indices(mesh, teeth)
    matrix, along = flank_matrices(ring, index)
    clock.finish("condensation")
    profile = tooth_profile(gear)
    load = uniform_pressure(mesh.sector.s, profile.s_form, gear.base_radius)
    checks = _ring_checks(ring, int(index[(teeth - 1) // 2]), load, matrix)
    clock.finish("checks")
    result = FlankCompliance(
        s=mesh.sector.s,
        teeth=mesh.teeth[index],
        matrix=0.5 * (matrix + matrix.T),
        along=along,
        s_form=profile.s_form,
        s_tip=profile.s_tip,
        contact_modulus=hypothesis.contact_modulus(gear.material),
        checks=checks,
        unknowns=2 * (len(mesh.points) - len(mesh.bore_nodes)),
        condensed_unknowns=ring.matrix.shape[0],
        seconds=clock.seconds,
        solver=FACTORIZATION,
    )
    return refuse_broken_laws(result)


def condensed_ring(gear: Toothing, mesh: GearMesh, hypothesis: PlaneHypothesis) -> Ring:
    """Assemble sector and hub, condense the sector, assemble and factorise the ring."""
    lame = hypothesis.lame_parameters(gear.material)
    normals = tooth_profile(gear).normal(mesh.sector.s)
    stiffness = stiffness_matrix(mesh.sector.points, mesh.sector.triangles, lame)
    sector = condense_sector(mesh, stiffness, normals)
    hub = None
    if mesh.hub is not None:
        hub = stiffness_matrix(mesh.hub.points, mesh.hub.triangles, lame, mesh.hub.thickness)
    return assemble_ring(mesh, sector, hub)


def tooth_indices(mesh: GearMesh, teeth: int) -> IntArray:
    """Return where the `teeth` teeth around tooth 0 stand in `mesh.teeth`."""
    center = int(np.flatnonzero(mesh.teeth == 0)[0])
    return center + np.arange(teeth) - (teeth - 1) // 2
