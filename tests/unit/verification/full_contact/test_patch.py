"""Plane strain elements, the patch test of two blocks, and contact of a given compliance."""

import itertools
from functools import cache

import numpy as np
import pytest
from contact_blocks import DEPTH, WIDTH, block

from fe_contact.material import Material
from verification.full_contact.condensation.active_set import ContactSystem, solve_active_set
from verification.full_contact.condensation.condensed_body import CondensedBody, condensed_body
from verification.full_contact.condensation.flank_curve import FlankCurve
from verification.full_contact.condensation.plane_strain_stiffness import plane_strain_stiffness
from verification.full_contact.condensation.weak_gap import WeakGap, weak_gap

FORCE = 4e5  # N/m

# without lateral contraction a block clamped at its back is strained evenly
SOFT, STIFF = Material(70e9, 0.0), Material(210e9, 0.0)


@cache
def blocks() -> tuple[CondensedBody, CondensedBody]:
    """Left of x = 0 and right of it."""
    return condensed_body(block(0), SOFT), condensed_body(block(1), STIFF)


def pressed(slave: int) -> tuple[WeakGap, ContactSystem]:
    """The right block moves towards the left one."""
    bodies = blocks()
    first, second = (FlankCurve(body.points[body.columns[0]]) for body in bodies)
    gap = weak_gap(
        (first, second), (first, second)[slave], slave, lambda p: np.tile([-1.0, 0.0], (len(p), 1))
    )
    forces = []
    for body, own in zip(bodies, gap.forces, strict=True):
        rows = (2 * body.columns[0][:, None] + np.arange(2)).ravel()
        spread = np.zeros((2 * len(body.nodes), own.shape[1]))
        spread[rows] = own
        forces.append(spread)
    compliance = sum(f.T @ body.compliance @ f for f, body in zip(forces, bodies, strict=True))
    return gap, ContactSystem(gap.gap, compliance, gap.closing, gap.closing, gap.weight)


@pytest.mark.parametrize("slave", [0, 1])
def test_a_flat_contact_carries_one_pressure_and_action_is_reaction(slave):
    _, system = pressed(slave)
    solution = solve_active_set(system, FORCE)
    assert solution.status.usable
    np.testing.assert_allclose(solution.pressure, FORCE / WIDTH, rtol=1e-12, atol=0.0)
    modulus = 1.0 / (1.0 / SOFT.youngs_modulus + 1.0 / STIFF.youngs_modulus)
    assert solution.lag == pytest.approx(FORCE / WIDTH * DEPTH / modulus, rel=1e-12)
    gap, system = pressed(slave)
    pressure = np.linspace(1.0, 2.0, len(gap.gap))
    totals = [(own @ pressure).reshape(-1, 2).sum(axis=0) for own in gap.forces]
    np.testing.assert_allclose(totals[0], -totals[1], rtol=1e-13, atol=1e-16 * WIDTH)
    assert totals[0][0] == pytest.approx(-gap.weight @ pressure, rel=1e-13)
    assert np.array_equal(system.compliance.shape, (len(pressure),) * 2)
    assert gap.weight.sum() == pytest.approx(WIDTH, rel=1e-13)


def test_what_passes_its_mate_by_is_left_out():
    """The mate shifted sideways by 0.4 of the width: only what still faces it counts."""
    bodies = blocks()
    first = FlankCurve(bodies[0].points[bodies[0].columns[0]])
    second = FlankCurve(bodies[1].points[bodies[1].columns[0]] + [0.1e-3, 0.4 * WIDTH])
    gap = weak_gap((first, second), first, 0, lambda p: np.tile([-1.0, 0.0], (len(p), 1)))
    assert gap.weight.sum() == pytest.approx(0.6 * WIDTH, rel=1e-12)
    np.testing.assert_allclose(gap.gap, 0.1e-3 * gap.weight, rtol=1e-12)
    centroid = gap.forces[1].reshape(-1, 2, len(gap.gap))[:, 0].sum(axis=1) @ second.nodes[:, 1]
    assert centroid / gap.weight.sum() == pytest.approx(0.7 * WIDTH, rel=1e-12)


def test_the_condensed_compliance_is_that_of_the_whole_body():
    body = blocks()[0]
    np.testing.assert_allclose(body.compliance, body.compliance.T, rtol=0.0, atol=0.0)
    assert np.linalg.eigvalsh(body.compliance).min() > 0.0
    forces = np.zeros(body.stiffness.shape[0])
    forces[body.freedoms] = np.random.default_rng(3).normal(size=len(body.freedoms))
    moved = body.solve(forces)
    condensed = body.compliance @ forces[body.freedoms]
    np.testing.assert_allclose(moved[body.freedoms], condensed, rtol=0.0, atol=1e-12 * np.abs(moved).max())
    held = (2 * body.body.bore_nodes[:, None] + np.arange(2)).ravel()
    assert np.all(moved[held] == 0.0)
    out = body.stiffness @ moved - forces
    out[held] = 0.0
    assert np.abs(out).max() < 1e-12 * np.abs(forces).max()


STEEL = Material(210e9, 0.3)

# two curved triangles that share a bent side
POINTS = 1e-3 * np.array(
    [[0, 0], [1, 0], [1, 1], [0, 1], [0.5, -0.05], [1.06, 0.5], [0.53, 0.46], [0.5, 1.04], [-0.03, 0.5]]
)
TRIANGLES = np.array([[0, 1, 2, 4, 5, 6], [0, 2, 3, 6, 7, 8]])


def area() -> float:
    """Enclosed by the four quadratic sides."""
    total = 0.0
    points, weights = np.polynomial.legendre.leggauss(4)
    for a, m, b in ((0, 4, 1), (1, 5, 2), (2, 7, 3), (3, 8, 0)):
        shape = np.stack([0.5 * points * (points - 1), 1 - points**2, 0.5 * points * (points + 1)], axis=1)
        slope = np.stack([points - 0.5, -2 * points, points + 0.5], axis=1)
        at, along = shape @ POINTS[[a, m, b]], slope @ POINTS[[a, m, b]]
        total += 0.5 * float(weights @ (at[:, 0] * along[:, 1] - at[:, 1] * along[:, 0]))
    return total


def test_rigid_motion_takes_no_force():
    matrix = plane_strain_stiffness(POINTS, TRIANGLES, STEEL).toarray()
    np.testing.assert_allclose(matrix, matrix.T, rtol=0.0, atol=1e-15 * matrix.max())
    turned = np.stack([-POINTS[:, 1], POINTS[:, 0]], axis=-1) / 1e-3
    for motion in (np.tile([1.0, 0.0], 9), np.tile([0.0, 1.0], 9), turned.ravel()):
        assert np.abs(matrix @ motion).max() < 1e-14 * matrix.max()
    assert np.sum(np.linalg.eigvalsh(matrix) > 1e-9 * matrix.max()) == len(matrix) - 3


def test_even_strain_stores_the_energy_of_plane_strain():
    matrix = plane_strain_stiffness(POINTS, TRIANGLES, STEEL)
    e, nu = STEEL.youngs_modulus, STEEL.poissons_ratio
    lam, mu = e * nu / ((1 + nu) * (1 - 2 * nu)), e / (2 * (1 + nu))
    for strain in ([[1.0, 0.0], [0.0, 0.0]], [[0.3, 0.4], [0.4, -0.2]]):
        moved = (POINTS @ np.array(strain)).ravel()
        density = lam * np.trace(strain) ** 2 + 2.0 * mu * float(np.sum(np.square(strain)))
        np.testing.assert_allclose(moved @ (matrix @ moved), density * area(), rtol=1e-10)


def random_system(seed: int, hats: int = 7) -> ContactSystem:
    """Hats with random gaps on a random body."""
    random = np.random.default_rng(seed)
    root = random.normal(size=(hats, hats))
    closing = random.uniform(0.5, 1.5, hats)
    lever = closing * random.uniform(0.99, 1.01, hats)
    return ContactSystem(
        gap=random.uniform(0.0, 3.0, hats),
        compliance=root @ root.T / hats + 0.2 * np.eye(hats),
        closing=closing,
        lever=lever,
        weight=closing,
    )


def by_enumeration(s: ContactSystem, torque: float) -> list[tuple[np.ndarray, float]]:
    """All sets of hats whose solution keeps the laws."""
    count, kept = len(s.gap), []
    for chosen in itertools.product([False, True], repeat=count):
        active = np.array(chosen)
        if not active.any():
            continue
        size = int(active.sum())
        matrix = np.zeros((size + 1, size + 1))
        matrix[:size, :size] = s.compliance[np.ix_(active, active)]
        matrix[:size, size], matrix[size, :size] = -s.closing[active], s.lever[active]
        solved = np.linalg.solve(matrix, np.append(-s.gap[active], torque))
        pressure = np.zeros(count)
        pressure[active] = solved[:size]
        gap = s.gap + s.compliance @ pressure - s.closing * solved[size]
        if pressure.min() >= 0.0 and gap.min() > -1e-10:
            kept.append((pressure, float(solved[size])))
    return kept


@pytest.mark.parametrize("seed", range(12))
def test_it_finds_the_one_set_that_keeps_the_laws(seed):
    case = random_system(seed)
    ((pressure, lag),) = by_enumeration(case, 2.0)
    solution = solve_active_set(case, 2.0)
    assert solution.status.usable
    np.testing.assert_allclose(solution.pressure, pressure, rtol=0.0, atol=1e-10)
    assert solution.lag == pytest.approx(lag, rel=1e-10)
    assert solution.residual < 1e-12


def test_the_lag_grows_with_the_torque_from_wherever_it_starts():
    case = random_system(5, hats=40)
    torques = np.geomspace(1e-3, 1e3, 25)
    lags = [solve_active_set(case, torque).lag for torque in torques]
    assert np.all(np.diff(lags) > 0.0)
    everywhere = solve_active_set(case, 1.0, np.ones(40, dtype=bool))
    assert everywhere.lag == pytest.approx(solve_active_set(case, 1.0).lag, rel=1e-12)
