"""Hexahedra of swept layers against scikit-fem's own assembly, rigid motion and constant strain."""

from dataclasses import replace

import numpy as np
import pytest
from skfem import Basis, ElementHex2, ElementHexS2, ElementVector, MeshHex, MeshHex2
from skfem.models.elasticity import linear_elasticity

from fe_contact.compliance.hexahedron_stiffness import (
    REFERENCE,
    cylindrical_frames,
    layer_nodes,
    stiffness_of,
)
from fe_contact.compliance.sector_stiffness import flank_frames, placed_layer, sector_stiffness, twist
from fe_contact.errors import MeshError
from fe_contact.geometry import BoreSeat, Gear
from fe_contact.mesh import QuadSector, SectorRecipe, SweptSector, quad_sector, swept_sector
from fe_contact.mesh.element_stack import Batch

LAME = (121e9, 81e9)
GEAR = Gear(17, 4e-3, 25e-3, 30e-3, helix_angle=0.5, profile_shift_coefficient=0.1)
RECIPE = replace(SectorRecipe.draft(GEAR), layers=8, merge_rows=(-1, -3))


@pytest.fixture(scope="module")
def section():
    return quad_sector(GEAR, RECIPE)


@pytest.fixture(scope="module")
def nodes(section):
    """Nodes (m, 20, 3) of one strongly turned layer."""
    return layer_nodes(section.points[section.grid.quads], 5e-3, 0.1)


def serendipity(at: np.ndarray) -> np.ndarray:
    """Twenty-node functions at points (n, 3) of -1 .. 1, (n, 20), from the textbook."""
    functions = []
    for corner in REFERENCE:
        factors = [1 + c * x if c else 1 - x**2 for c, x in zip(corner, at.T, strict=True)]
        product = np.prod(factors, axis=0)
        functions.append(product * (at @ corner - 2) / 8 if corner.all() else product / 4)
    return np.stack(functions, axis=-1)


def test_equals_the_assembly_of_scikit_fem(nodes):
    count = 40
    some = nodes[::4][:count]
    count = len(some)
    # Elements apart from each other; 27-node geometry that holds the 20-node one exactly.
    corner_order = [REFERENCE.tolist().index(list(2 * x - 1)) for x in ElementHex2.doflocs[:8]]
    loose = MeshHex(
        some[:, corner_order].reshape(-1, 3).T.copy(), np.arange(8 * count).reshape(count, 8).T.copy()
    )
    numbering = Basis(loose, ElementHex2()).element_dofs
    places = np.empty((3, numbering.max() + 1))
    places[:, numbering] = np.einsum("ak,mkx->xam", serendipity(2 * ElementHex2.doflocs - 1), some)
    mesh = MeshHex2(places, loose.t)
    basis = Basis(mesh, ElementVector(ElementHexS2()), intorder=5)
    matrix = linear_elasticity(*LAME).assemble(basis).toarray()
    here = [int(np.abs(ElementHexS2.doflocs - 0.5 * (x + 1)).sum(axis=1).argmin()) for x in REFERENCE]
    order = (3 * np.array(here)[:, None] + np.arange(3)).ravel()
    found = stiffness_of(some, LAME)
    for e in range(count):
        dofs = basis.element_dofs[order, e]
        assert found[e] == pytest.approx(matrix[np.ix_(dofs, dofs)], abs=1e-12 * np.abs(found[e]).max())


def test_only_the_six_rigid_motions_are_free(nodes):
    for stiffness in stiffness_of(nodes[::20], LAME):
        assert (
            np.array_equal(stiffness, stiffness.T)
            or np.abs(stiffness - stiffness.T).max() < 1e-13 * np.abs(stiffness).max()
        )
        values = np.linalg.eigvalsh(stiffness)
        assert np.sum(values < 1e-9 * values[-1]) == 6
        assert values[0] > -1e-12 * values[-1]


def test_a_rotation_about_the_axis_is_tangential(section):
    quads = np.arange(0, len(section.grid.quads), 20)
    batch = Batch(quads, 5e-3, 0, np.arange(len(quads))[None])
    nodes, transform = placed_layer(section, batch, np.tile(np.eye(3), (section.grid.nodes, 1, 1)), 20.0)
    assert nodes == pytest.approx(
        layer_nodes(section.points[section.grid.quads[quads]], 5e-3, 0.1), abs=1e-16
    )
    motion = np.zeros_like(nodes)
    motion[..., 1] = np.hypot(nodes[..., 0], nodes[..., 1])
    cartesian = (transform @ motion.reshape(-1, 60, 1)).reshape(nodes.shape)
    assert cartesian == pytest.approx(np.cross([0.0, 0.0, 1.0], nodes), abs=1e-15)


def test_a_folded_element_is_named(section):
    squares = section.points[section.grid.quads]
    squares[2] = squares[2][[1, 0, 3, 2, 4, 7, 6, 5]]  # clockwise
    with pytest.raises(MeshError, match=r"element 2 at .* is folded"):
        stiffness_of(layer_nodes(squares, 1e-3, 0.1), LAME)


def node_positions(section: QuadSector, sector: SweptSector) -> np.ndarray:
    """Where the nodes of a sector are, (N, 3)."""
    ends = sector.layers.ends
    z = np.empty(2 * len(ends) - 1)
    z[::2], z[1::2] = ends, 0.5 * (ends[1:] + ends[:-1])
    angle = z * twist(GEAR)
    x, y = section.points.T
    c, s = np.cos(angle)[:, None], np.sin(angle)[:, None]
    places = np.stack([c * x - s * y, s * x + c * y, np.broadcast_to(z[:, None], (len(z), len(x)))], axis=-1)
    return places[sector.nodes >= 0]


class FreeBore:
    """Nothing is held."""

    name = "free"
    seat = BoreSeat()

    def constrained(self, grid: object, z: np.ndarray) -> np.ndarray:
        return np.zeros((len(z), grid.nodes, 3), dtype=bool)


def test_constant_strain_is_exact_in_a_merged_helical_sector(section):
    """Patch test: inner nodes, hanging ones included, balance under a linear field; the energy is exact."""
    sector = swept_sector(section.grid, GEAR.face_width, RECIPE, FreeBore())
    frames = flank_frames(section, twist(GEAR))
    stiffness = sector_stiffness(GEAR, section, sector)
    places = node_positions(section, sector)
    axes = cylindrical_frames(places[None])[0]
    at_flank = sector.nodes[:, section.grid.flank]
    for j in range(len(section.grid.flank)):
        on = at_flank[:, j][at_flank[:, j] >= 0]
        axes[on] = axes[on] @ frames[j]
    gradient = np.array([[3e-4, -1e-4, 2e-4], [5e-4, 2e-4, -3e-4], [1e-4, 4e-4, -2e-4]])
    field = np.einsum("nac,na->nc", axes, places @ gradient.T)
    freedoms = sector.element_freedoms
    local = field.ravel()[freedoms]
    element = np.einsum("eij,ej->ei", stiffness.matrices[stiffness.of_element], local)
    forces = np.bincount(freedoms.ravel(), element.ravel()).reshape(-1, 3)
    grid = section.grid
    edge = np.zeros(grid.nodes, dtype=bool)
    middle, count = np.unique(grid.quads[:, 4:], return_counts=True)
    edge[middle[count == 1]] = True
    for i in range(4):
        ends = grid.quads[np.isin(grid.quads[:, 4 + i], middle[count == 1])]
        edge[ends[:, [i, (i + 1) % 4]]] = True
    boundary = np.tile(edge, (len(sector.nodes), 1))
    boundary[[0, -1]] = True
    inner = ~boundary[sector.nodes >= 0]
    assert inner.sum() > 500
    assert np.abs(forces[inner]).max() < 1e-11 * np.abs(forces).max()
    strain = 0.5 * (gradient + gradient.T)
    E, nu = GEAR.material.youngs_modulus, GEAR.material.poissons_ratio
    lam, mu = E * nu / ((1 + nu) * (1 - 2 * nu)), 0.5 * E / (1 + nu)
    density = lam * np.trace(strain) ** 2 + 2 * mu * np.sum(strain**2)
    cartesian = np.einsum("nac,nc->na", axes, forces)
    stress = lam * np.trace(strain) * np.eye(3) + 2 * mu * strain
    virial = np.einsum("na,nb->ab", cartesian, places)
    volume = virial[0, 0] / stress[0, 0]
    assert virial == pytest.approx(stress * volume, rel=1e-9, abs=1e-10 * np.abs(virial).max())
    assert float(np.sum(field * forces)) == pytest.approx(density * volume, rel=1e-9)


def test_the_flank_frame_is_the_helicoid(section):
    frames = flank_frames(section, twist(GEAR))
    assert np.einsum("kab,kac->kbc", frames, frames) == pytest.approx(
        np.tile(np.eye(3), (len(frames), 1, 1)), abs=1e-14
    )
    points = section.points[section.grid.flank]
    involute = section.s >= section.s[-1] - 1e-3
    # Along the helix (0, r dphi/dz, 1) the flank is not crossed.
    helix = np.stack([0.0 * points[:, 0], np.hypot(*points.T) * twist(GEAR), np.ones(len(points))], axis=1)
    assert np.abs(np.sum(frames[..., 0] * helix, axis=1)).max() < 1e-14
    # Normals of an involute helicoid rise at the base helix angle and touch the base cylinder (ISO 21771-1).
    assert frames[involute, 2, 0] == pytest.approx(np.sin(GEAR.base_helix_angle), rel=1e-12)
    lever = -frames[involute, 1, 0] * np.hypot(*points[involute].T)
    assert lever == pytest.approx(GEAR.base_radius * np.cos(GEAR.base_helix_angle), rel=1e-12)
