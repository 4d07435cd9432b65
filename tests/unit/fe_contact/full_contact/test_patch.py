"""Patch test: two blocks with unlike meshes pressed flat together carry one pressure, to rounding."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from contact_blocks import DEPTH, WIDTH, block

from fe_contact.full_contact.condensation.contact_model import _condensed_body, _CondensedBody
from fe_contact.full_contact.condensation.linearized_contact import ContactSystem, solve_active_set
from fe_contact.full_contact.condensation.weak_gap import FlankCurve, WeakGap, weak_gap
from fe_contact.material import Material

FORCE = 4e5  # N/m
# without lateral contraction a block clamped at its back is strained evenly
SOFT, STIFF = Material(70e9, 0.0), Material(210e9, 0.0)


@cache
def blocks() -> tuple[_CondensedBody, _CondensedBody]:
    """Left of x = 0 and right of it."""
    return _condensed_body(block(0), SOFT), _condensed_body(block(1), STIFF)


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
def test_a_flat_contact_carries_one_pressure(slave: int) -> None:
    _, system = pressed(slave)
    solution = solve_active_set(system, FORCE)
    assert solution.status.usable
    np.testing.assert_allclose(solution.pressure, FORCE / WIDTH, rtol=1e-12, atol=0.0)
    modulus = 1.0 / (1.0 / SOFT.youngs_modulus + 1.0 / STIFF.youngs_modulus)
    assert solution.lag == pytest.approx(FORCE / WIDTH * DEPTH / modulus, rel=1e-12)


@pytest.mark.parametrize("slave", [0, 1])
def test_action_is_reaction(slave: int) -> None:
    gap, system = pressed(slave)
    pressure = np.linspace(1.0, 2.0, len(gap.gap))
    totals = [(own @ pressure).reshape(-1, 2).sum(axis=0) for own in gap.forces]
    np.testing.assert_allclose(totals[0], -totals[1], rtol=1e-13, atol=1e-16 * WIDTH)
    assert totals[0][0] == pytest.approx(-gap.weight @ pressure, rel=1e-13)
    assert np.array_equal(system.compliance.shape, (len(pressure),) * 2)
    assert gap.weight.sum() == pytest.approx(WIDTH, rel=1e-13)


def test_what_passes_its_mate_by_is_left_out() -> None:
    """The mate shifted sideways by 0.4 of the width: only what still faces it counts."""
    bodies = blocks()
    first = FlankCurve(bodies[0].points[bodies[0].columns[0]])
    second = FlankCurve(bodies[1].points[bodies[1].columns[0]] + [0.1e-3, 0.4 * WIDTH])
    gap = weak_gap((first, second), first, 0, lambda p: np.tile([-1.0, 0.0], (len(p), 1)))
    assert gap.weight.sum() == pytest.approx(0.6 * WIDTH, rel=1e-12)
    np.testing.assert_allclose(gap.gap, 0.1e-3 * gap.weight, rtol=1e-12)
    centroid = gap.forces[1].reshape(-1, 2, len(gap.gap))[:, 0].sum(axis=1) @ second.nodes[:, 1]
    assert centroid / gap.weight.sum() == pytest.approx(0.7 * WIDTH, rel=1e-12)


def test_the_condensed_compliance_is_that_of_the_whole_body() -> None:
    body = blocks()[0]
    np.testing.assert_allclose(body.compliance, body.compliance.T, rtol=0.0, atol=0.0)
    assert np.linalg.eigvalsh(body.compliance).min() > 0.0
    forces = np.zeros(body.stiffness.shape[0])
    forces[body.freedoms] = np.random.default_rng(3).normal(size=len(body.freedoms))
    moved = body.solve(forces)
    condensed = body.compliance @ forces[body.freedoms]
    np.testing.assert_allclose(moved[body.freedoms], condensed, rtol=0.0, atol=1e-12 * np.abs(moved).max())
    held = (2 * body.body.held[:, None] + np.arange(2)).ravel()
    assert np.all(moved[held] == 0.0)
    out = body.stiffness @ moved - forces
    out[held] = 0.0
    assert np.abs(out).max() < 1e-12 * np.abs(forces).max()
