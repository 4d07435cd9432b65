"""Plane elasticity against exact solutions: patch test, and a clamped ring (level and rate)."""

from collections.abc import Callable

import numpy as np
import pytest
import scipy.sparse as sp
from scipy.sparse.linalg import splu
from skfem import Basis, ElementTriP2, ElementVector, MeshTri2
from skfem.models.elasticity import linear_elasticity

from fe_contact import Gear, Material
from fe_contact.compliance import PlaneHypothesis
from fe_contact.compliance.plane_elasticity import stiffness_matrix
from fe_contact.mesh import MeshRecipe, mesh_gear

STEEL = Material()
HYPOTHESES = list(PlaneHypothesis)
INNER, OUTER = 20e-3, 45e-3


@pytest.mark.parametrize("hypothesis", HYPOTHESES, ids=lambda h: h.value)
def test_patch_of_curved_elements_keeps_constant_strain(hypothesis):
    gear = Gear(teeth=20, normal_module=4e-3, face_width=25e-3, bore_diameter=40e-3)
    sector = mesh_gear(gear, MeshRecipe.standard(gear)).sector
    lam, mu = hypothesis.lame_parameters(STEEL)
    matrix = stiffness_matrix(sector.points, sector.triangles, (lam, mu))
    gradient = np.array([[3e-4, -1e-4], [5e-4, 2e-4]])
    forces = (matrix @ (sector.points @ gradient.T).ravel()).reshape(-1, 2)
    strain = 0.5 * (gradient + gradient.T)
    stress = lam * np.trace(strain) * np.eye(2) + 2.0 * mu * strain
    loaded = np.linalg.norm(forces, axis=1) > 1e-9 * np.abs(forces).max()
    assert loaded.sum() < 0.2 * len(forces)  # inner nodes are in balance, only the boundary is loaded
    # Virtual work of the boundary forces on any linear field is stress : strain times the area.
    area = sum(np.sum(forces[:, i] * sector.points[:, i]) for i in range(2)) / np.trace(stress)
    moments = forces.T @ sector.points
    assert moments == pytest.approx(stress * area, rel=1e-9, abs=1e-9 * np.abs(moments).max())
    exact = element_areas(sector.points, sector.triangles)
    assert area == pytest.approx(exact, rel=1e-9)


def test_equals_the_weak_form_of_scikit_fem():
    """In its own vector element, apart from numbers of nodes: the same energy of any motion."""
    points, triangles = ring_mesh(6)
    lame = PlaneHypothesis.PLANE_STRESS.lame_parameters(STEEL)
    basis = Basis(MeshTri2(points.T, triangles.T), ElementVector(ElementTriP2()), intorder=4)
    expected = linear_elasticity(*lame).assemble(basis)
    number = np.empty(2 * len(points), dtype=int)
    number[(2 * triangles[:, :, None] + np.arange(2)).reshape(-1, 12).T] = basis.element_dofs
    found = stiffness_matrix(points, triangles, lame, np.full(len(triangles), 0.3))
    difference = found - 0.3 * expected[number][:, number]
    assert abs(difference).max() < 1e-12 * abs(found).max()


def element_areas(points: np.ndarray, triangles: np.ndarray) -> float:
    """Area inside six-node triangles, by the exact line integral along their sides."""
    total = 0.0
    for first, middle, last in ((0, 3, 1), (1, 4, 2), (2, 5, 0)):
        a, m, b = (points[triangles[:, i]] for i in (first, middle, last))
        for p, q, weight in ((a, m, 4.0), (m, b, 4.0), (a, b, -1.0)):
            total += weight / 6.0 * float(np.sum(p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]))
    return total


def test_rigid_motion_costs_no_energy():
    points, triangles = ring_mesh(6)
    matrix = stiffness_matrix(points, triangles, PlaneHypothesis.PLANE_STRAIN.lame_parameters(STEEL))
    turned = np.stack([-points[:, 1], points[:, 0]], axis=-1)
    for motion in (np.tile([1.0, 0.0], (len(points), 1)), np.tile([0.0, 1.0], (len(points), 1)), turned):
        scale = np.abs(matrix).max() * np.abs(motion).max()
        assert np.abs(matrix @ motion.ravel()).max() < 1e-12 * scale


def ring_mesh(radial: int) -> tuple[np.ndarray, np.ndarray]:
    """Ring of curved quadratic triangles, `radial` elements deep, nodes on exact circles."""
    around = 8 * radial
    radius = np.linspace(INNER, OUTER, 2 * radial + 1)
    angle = np.linspace(0.0, 2.0 * np.pi, 2 * around, endpoint=False)
    points = np.stack([radius[:, None] * np.cos(angle), radius[:, None] * np.sin(angle)], axis=-1).reshape(
        -1, 2
    )

    def node(i, j):
        return i * 2 * around + j % (2 * around)

    i, j = (2 * a.ravel() for a in np.meshgrid(np.arange(radial), np.arange(around), indexing="ij"))
    lower = [(0, 0), (2, 0), (2, 2), (1, 0), (2, 1), (1, 1)]
    upper = [(0, 0), (2, 2), (0, 2), (1, 1), (1, 2), (0, 1)]
    triangles = [np.stack([node(i + a, j + b) for a, b in half], axis=-1) for half in (lower, upper)]
    return points, np.concatenate(triangles)


def outer_work(
    radial: int, hypothesis: PlaneHypothesis, traction: Callable[[np.ndarray], np.ndarray]
) -> float:
    """Work per load of unit traction on the outer circle of the ring, bore clamped."""
    points, triangles = ring_mesh(radial)
    matrix = stiffness_matrix(points, triangles, hypothesis.lame_parameters(STEEL))
    loads = np.zeros_like(points)
    rim = np.arange(len(points) - 16 * radial, len(points))
    ends = np.roll(rim, -2)[::2]
    t, weight = np.polynomial.legendre.leggauss(6)
    t, weight = 0.5 * (t + 1.0), 0.5 * weight
    shapes = np.stack([(2 * t - 1) * (t - 1), 4 * t * (1 - t), t * (2 * t - 1)])
    slopes = np.stack([4 * t - 3, 4 - 8 * t, 4 * t - 1])
    for nodes in zip(rim[::2], rim[1::2], ends, strict=True):
        on = list(nodes)
        where, along = shapes.T @ points[on], slopes.T @ points[on]
        length = np.linalg.norm(along, axis=1) * weight
        loads[on] += shapes @ (traction(where) * length[:, None])
    free = np.arange(2 * 16 * radial, 2 * len(points))
    u = np.zeros(points.size)
    u[free] = splu(sp.csc_array(matrix[free][:, free])).solve(loads.ravel()[free])
    return float(u @ loads.ravel())


def along_rim(where: np.ndarray) -> np.ndarray:
    return np.stack([-where[:, 1], where[:, 0]], axis=-1) / np.linalg.norm(where, axis=1, keepdims=True)


def inward(where: np.ndarray) -> np.ndarray:
    return -where / np.linalg.norm(where, axis=1, keepdims=True)


def exact_shear(hypothesis: PlaneHypothesis) -> float:
    """u_t(b) 2 pi b with u_t = (tau b^2 / 2 mu) (r / a^2 - 1 / r)."""
    _, mu = hypothesis.lame_parameters(STEEL)
    return np.pi * OUTER**3 / mu * (OUTER / INNER**2 - 1.0 / OUTER)


def exact_pressure(hypothesis: PlaneHypothesis) -> float:
    """-u_r(b) 2 pi b with u_r = C (r - a^2 / r), C = -p / (2 (lambda + mu) + 2 mu a^2 / b^2) (Lame)."""
    lam, mu = hypothesis.lame_parameters(STEEL)
    constant = 1.0 / (2.0 * (lam + mu) + 2.0 * mu * (INNER / OUTER) ** 2)
    return 2.0 * np.pi * OUTER * constant * (OUTER - INNER**2 / OUTER)


@pytest.mark.parametrize("hypothesis", HYPOTHESES, ids=lambda h: h.value)
@pytest.mark.parametrize(
    ("traction", "exact"), [(along_rim, exact_shear), (inward, exact_pressure)], ids=["shear", "pressure"]
)
def test_clamped_ring_converges_to_its_closed_form_at_fourth_order(
    hypothesis, traction, exact, record_figure
):
    expected = exact(hypothesis)
    errors = [abs(outer_work(n, hypothesis, traction) / expected - 1.0) for n in (3, 6, 12)]
    rates = np.log2(np.array(errors[:-1]) / errors[1:])
    assert errors[-1] < 2e-6
    assert rates[-1] == pytest.approx(4.0, abs=0.25)  # energy of quadratic elements: h^(2 * 2)
    name = f"clamped ring, {exact.__name__.removeprefix('exact_')}, {hypothesis.value}"
    record_figure(
        f"{name}: error of the work", errors[-1], "at most 2e-6", "1", "Lame; Timoshenko and Goodier"
    )
    record_figure(
        f"{name}: convergence rate", rates[-1], "4 within 0.25", "1", "theory of quadratic elements"
    )
