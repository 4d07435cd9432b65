"""Stress of a free surface from the displacement of its nodes: exact fields, rates, and finite elements."""

from collections.abc import Callable

import numpy as np
import pytest
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from fe_contact.compliance import PlaneHypothesis
from fe_contact.compliance.plane_elasticity import stiffness_matrix
from fe_contact.compliance.root_surface import STATIONS, between_nodes
from fe_contact.compliance.root_surface_3d import ACROSS, ALONG, SurfaceElements, face_stress
from fe_contact.compliance.unit_root_stress import edge_stress
from fe_contact.material import Material

STEEL = Material()
STRAIN, STRESS = PlaneHypothesis.PLANE_STRAIN, PlaneHypothesis.PLANE_STRESS
Displacement = Callable[[np.ndarray], np.ndarray]


def test_values_between_nodes_are_those_of_the_parabola():
    s = np.array([0.0, 1.0, 2.0, 3.5, 5.0])
    at = between_nodes(s)
    assert at == pytest.approx(
        [1.0 + STATIONS[0], 1.0 + STATIONS[1], 3.5 + 1.5 * STATIONS[0], 3.5 + 1.5 * STATIONS[1]]
    )
    assert between_nodes(2.0 - s + 3.0 * s**2) == pytest.approx(2.0 - at + 3.0 * at**2, rel=1e-14)


def hole(edges: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A quarter of a hole of radius 1: nodes, chain, and the polar angles of its stations."""
    angle = np.linspace(0.0, 0.5 * np.pi, 2 * edges + 1)
    points = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    return points, np.arange(len(points)), between_nodes(angle)


@pytest.mark.parametrize("hypothesis", [STRAIN, STRESS])
def test_stress_round_a_hole_converges_with_the_cube(hypothesis):
    """Kirsch: a plate in unit tension moves on the hole by 2/E' (r (1 + 2 cos 2t), -2 sin 2t) / 2."""
    errors = []
    for edges in (4, 8, 16):
        points, chain, at = hole(edges)
        angle = np.arctan2(points[:, 1], points[:, 0])
        radial, around = 1.0 + 2.0 * np.cos(2.0 * angle), -2.0 * np.sin(2.0 * angle)
        c, s = np.cos(angle), np.sin(angle)
        moved = np.stack([c * radial - s * around, s * radial + c * around], axis=1)
        moved /= hypothesis.contact_modulus(STEEL)
        found = (edge_stress(points, chain, STEEL, hypothesis) @ moved.ravel()).reshape(3, -1)
        exact = 1.0 - 2.0 * np.cos(2.0 * at)
        errors.append(np.abs(found[0] - exact).max())
        held = STEEL.poissons_ratio if hypothesis is STRAIN else 0.0
        assert found[1] == pytest.approx(held * found[0], rel=1e-12)
        assert not found[2].any()
    assert np.log2(errors[0] / errors[1]) > 2.9  # at other points of the edges it is 2
    assert np.log2(errors[1] / errors[2]) > 2.9
    assert errors[1] < 0.01


def curved_beam(radial: int, around: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A quarter ring, 1 <= r <= 2, in six-node triangles: points, triangles, and polar coordinates."""
    r, t = np.linspace(1.0, 2.0, 2 * radial + 1), np.linspace(0.0, 0.5 * np.pi, 2 * around + 1)
    grid = np.arange(r.size * t.size).reshape(t.size, r.size)
    polar = np.stack([np.tile(r, t.size), np.repeat(t, r.size)], axis=1)
    triangles = []
    for j in range(0, 2 * around, 2):
        for i in range(0, 2 * radial, 2):
            g = grid[j : j + 3, i : i + 3]
            triangles += [
                [g[0, 0], g[0, 2], g[2, 2], g[0, 1], g[1, 2], g[1, 1]],
                [g[0, 0], g[2, 2], g[2, 0], g[1, 1], g[2, 1], g[1, 0]],
            ]
    points = polar[:, :1] * np.stack([np.cos(polar[:, 1]), np.sin(polar[:, 1])], axis=1)
    return points, np.array(triangles), polar


def beam_stress(r: np.ndarray, t: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Unit shear force on the end of a curved bar, radii 1 and 2 (Timoshenko and Goodier, article 33)."""
    n = 1.0 - 4.0 + 5.0 * np.log(2.0)
    common = (r + 4.0 / r**3 - 5.0 / r) / n
    return common * np.sin(t), (3.0 * r - 4.0 / r**3 - 5.0 / r) / n * np.sin(t), -common * np.cos(t)


def end_forces(points: np.ndarray, polar: np.ndarray, end: float, outward: float) -> np.ndarray:
    """Consistent forces (n, 2) of the exact traction on the end at polar angle `end`."""
    nodes = np.flatnonzero(np.isclose(polar[:, 1], end))
    nodes = nodes[np.argsort(polar[nodes, 0])]
    forces = np.zeros_like(points)
    x, weight = np.polynomial.legendre.leggauss(8)
    shapes = np.stack([0.5 * x * (x - 1.0), 1.0 - x * x, 0.5 * x * (x + 1.0)])
    c, s = np.cos(end), np.sin(end)
    for e in range(0, len(nodes) - 2, 2):
        three = nodes[e : e + 3]
        r = shapes.T @ polar[three, 0]
        _, around, shear = beam_stress(r, np.full_like(r, end))
        share = 0.5 * (polar[three[2], 0] - polar[three[0], 0]) * weight * outward
        forces[three, 0] += shapes @ (share * (shear * c - around * s))
        forces[three, 1] += shapes @ (share * (shear * s + around * c))
    return forces


def inner_stress_error(refinement: int) -> float:
    """Largest error on the inner radius, over the largest stress, in the middle half of the bar."""
    points, triangles, polar = curved_beam(2 * refinement, 4 * refinement)
    matrix = stiffness_matrix(points, triangles, STRESS.lame_parameters(STEEL))
    load = end_forces(points, polar, 0.0, -1.0) + end_forces(points, polar, 0.5 * np.pi, 1.0)
    assert np.abs(load.sum(axis=0)).max() < 1e-4  # the tractions balance but for their quadrature
    low, high = (
        np.argmin(np.abs(polar - [1.0, 0.5 * np.pi]).sum(axis=1)),
        np.argmin(np.abs(polar - [2.0, 0.5 * np.pi]).sum(axis=1)),
    )
    free = np.setdiff1d(np.arange(2 * len(points)), [2 * low, 2 * low + 1, 2 * high])
    moved = np.zeros(2 * len(points))
    moved[free] = splu(sp.csc_array(matrix[free][:, free])).solve(load.ravel()[free])
    chain = np.flatnonzero(np.isclose(polar[:, 0], 1.0))
    found = (edge_stress(points, chain, STEEL, STRESS) @ moved)[: len(chain) - 1]
    at = between_nodes(polar[chain, 1])
    exact = beam_stress(np.ones_like(at), at)[1]
    middle = (at > np.pi / 8.0) & (at < 3.0 * np.pi / 8.0)
    return float(np.abs(found - exact)[middle].max() / np.abs(exact).max())


def test_stress_of_a_curved_bar_converges_with_the_square(record_figure):
    errors = [inner_stress_error(n) for n in (1, 2, 4)]
    rate = float(np.log2(errors[1] / errors[2]))
    assert rate == pytest.approx(2.0, abs=0.2)
    assert errors[2] < 2e-3
    record_figure(
        "surface stress of a curved bar: error with 16 edges along the quarter", errors[2],
        "at most 0.002", "1", "Timoshenko and Goodier, Theory of Elasticity, article 33",
    )  # fmt: skip
    name = "surface stress of a curved bar: convergence rate"
    record_figure(name, rate, "2 within 0.2", "1", "derivative of quadratics")


def shaft(layers: int, radius: float, skew: float) -> SurfaceElements:
    """Surface of a round shaft in elements whose uprights lean by `skew` rad per length."""
    places = []
    for layer in range(layers):
        for edge in range(2 * layers):
            z = (layer + 0.5 * (1.0 + ACROSS)) / layers
            t = (edge + 0.5 * (1.0 + ALONG)) / (2 * layers) * 0.5 + skew * z
            places.append(np.stack([radius * np.cos(t), radius * np.sin(t), z], axis=1))
    nodes = np.array(places)
    axes = np.tile(np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0], (len(nodes), 8, 1, 1))
    return SurfaceElements(nodes, axes, np.arange(nodes.size).reshape(nodes.shape))


def stress_of(elements: SurfaceElements, field: Displacement) -> np.ndarray:
    """Stresses (3, stations) where the nodes move by `field`, given and taken in Cartesian components."""
    moved = np.einsum("miab,mia->mib", elements.frames, field(elements.nodes))
    rows = face_stress(elements, STEEL, elements.freedoms.size)
    return np.asarray(rows @ moved.ravel()).reshape(3, -1)


@pytest.mark.parametrize("skew", [0.0, 0.7])
def test_a_prism_in_tension_carries_it_on_its_surface(skew):
    """Exact on any element: the displacement is linear, and the surface is free."""
    elements = shaft(2, 0.8, 0.0)
    nu, E = STEEL.poissons_ratio, STEEL.youngs_modulus

    def stretched(x):
        return x * [-nu, -nu, 1.0] / E

    along, across, shear = stress_of(elements, stretched)
    assert across == pytest.approx(1.0, rel=1e-12)
    assert along == pytest.approx(0.0, abs=1e-12)
    assert shear == pytest.approx(0.0, abs=1e-12)
    # on elements that lean the invariants are the same
    along, across, shear = stress_of(shaft(2, 0.8, skew), stretched)
    assert along + across == pytest.approx(1.0, rel=5e-3)
    assert along * across - shear**2 == pytest.approx(0.0, abs=5e-3)


def test_neither_a_turn_nor_a_held_freedom_gives_stress():
    spin = np.array([[0.0, -3.0, 2.0], [3.0, 0.0, -1.0], [-2.0, 1.0, 0.0]]) / STEEL.youngs_modulus
    found = stress_of(shaft(2, 0.8, 0.7), lambda x: x @ spin.T + 0.1 / STEEL.youngs_modulus)
    assert np.abs(found).max() < 1e-12  # a stretch of that size gives 3
    elements = shaft(1, 0.8, 0.0)
    held = elements._replace(freedoms=np.where(np.arange(3) == 2, -1, elements.freedoms))
    all_rows, rows = (face_stress(e, STEEL, elements.freedoms.size) for e in (elements, held))
    kept = elements.freedoms[..., :2].ravel()
    assert (rows - all_rows)[:, kept].nnz == 0 or np.abs((rows - all_rows)[:, kept]).max() == 0.0
    assert abs(rows[:, elements.freedoms[..., 2].ravel()]).sum() == 0.0


@pytest.mark.parametrize("skew", [0.0, 0.7])
def test_a_twisted_shaft_is_sheared(skew):
    """u = w z (-y, x, 0): shear of G w a between circumference and axis, nothing else; sign by z x r."""
    radius, G = 0.8, 0.5 * STEEL.youngs_modulus / (1.0 + STEEL.poissons_ratio)
    errors = []
    for layers in (1, 2):
        found = stress_of(
            shaft(layers, radius, skew),
            lambda x: (
                np.stack([-x[..., 1] * x[..., 2], x[..., 0] * x[..., 2], 0.0 * x[..., 2]], axis=-1)
                / (G * radius)
            ),
        )
        errors.append(np.abs(found - np.array([[0.0], [0.0], [1.0]])).max())
    assert errors[1] < 0.01
    assert errors[1] < 0.3 * errors[0] or errors[0] < 1e-6
