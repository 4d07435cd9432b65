"""Loads of planets on an elastic ring, and lines beside the mesh frequency."""

import numpy as np
import pytest
from rings import LUGS, mesh_port, ring_of

from dynamics.elastic_ring.load_sharing import load_shares
from dynamics.elastic_ring.ring_compliance import HeldRing
from dynamics.elastic_ring.ring_support import RingSupport
from dynamics.elastic_ring.side_lines import side_lines

STIFFNESS, FORCE, LATE = 2e8, 3e4, 10e-6
FIT = RingSupport(fit_radial=1e9, fit_tangential=2e9)


def shares(planets, ring, floats, force=FORCE, late=LATE):
    angle = 2.0 * np.pi * np.arange(planets) / planets
    error = np.zeros(planets)
    error[0] = late
    return load_shares(np.full(planets, STIFFNESS), ring, error, force, angle, floats=floats)


@pytest.mark.parametrize("planets", [3, 4, 5])
def test_on_a_rigid_ring_the_late_planet_lacks_its_error_times_its_stiffness(planets):
    """F_1 = F / N - k e (N - 1) / N where the sun is held."""
    found = shares(planets, np.zeros((planets, planets)), floats=False)
    lacks = STIFFNESS * LATE * (planets - 1) / planets
    assert found.share[0] == pytest.approx(1.0 - lacks / (FORCE / planets), rel=1e-12)
    assert found.share[1:] == pytest.approx(np.full(planets - 1, found.share[1]), rel=1e-12)
    assert found.share.sum() == pytest.approx(planets) and found.residual < 1e-9


def test_three_planets_share_alike_where_the_sun_floats():
    ring = HeldRing(ring_of(0.12), LUGS).compliance(mesh_port(ring_of(0.12), 2.0 * np.pi * np.arange(3) / 3))
    assert shares(3, ring, floats=True).share == pytest.approx(np.ones(3), rel=1e-9)


def test_four_planets_share_by_their_square_pattern_where_the_sun_floats():
    """The sun takes the sum and both translations: + - + - stays, of which one error has a quarter."""
    found = shares(4, np.zeros((4, 4)), floats=True)
    change = 0.25 * STIFFNESS * LATE / (FORCE / 4)
    assert found.share == pytest.approx(1.0 + change * np.array([-1.0, 1.0, -1.0, 1.0]), rel=1e-12)


def test_a_softer_ring_shares_better():
    angle, late = 2.0 * np.pi * np.arange(4) / 4, []
    for slenderness in (0.6, 0.2, 0.1, 0.05):
        ring = ring_of(slenderness)
        held = HeldRing(ring, RingSupport(lugs=4, first_lug=0.4, lug_radial=1e9, lug_tangential=1e9))
        late.append(shares(4, held.compliance(mesh_port(ring, angle)), floats=True).share[0])
    assert np.all(np.diff(late) > 0.0) and late[-1] < 1.0


def test_a_planet_that_lifted_off_at_first_touches_again():
    """Two planets are late; held by the others alone the sun comes nearer to one of them."""
    angle = 2.0 * np.pi * np.arange(5) / 5
    error = np.array([2e-4, 1.2e-4, 0.0, 0.0, 0.0])
    stiffness, ring = np.full(5, STIFFNESS), np.zeros((5, 5))
    for force in np.geomspace(1e2, 1e5, 13):
        found = load_shares(stiffness, ring, error, force, angle, floats=True)
        carried = found.share * force / 5
        assert np.all(carried >= 0.0) and carried.sum() == pytest.approx(force)
        assert (carried * np.exp(1j * angle)).sum() == pytest.approx(0.0, abs=1e-8 * force)
        assert found.residual < 1e-9


def test_a_planet_that_is_too_late_carries_nothing_and_the_others_all():
    found = shares(4, np.zeros((4, 4)), floats=False, force=1e3)
    assert found.share[0] == 0.0
    assert found.share[1:] == pytest.approx(np.full(3, 4.0 / 3.0), rel=1e-12)


def test_equal_planets_leave_multiples_of_their_number_alone():
    """The lines are those of a ring of which each planet's force is followed one by one."""
    ring, planets, order = ring_of(0.12), 4, 98
    held, mesh = HeldRing(ring, LUGS), mesh_port(ring, np.zeros(1))
    lines = side_lines(held, mesh, order, planets, 12)
    assert list(lines.order) == [order + beside for beside in (-10, -6, -2, 2, 6, 10)]
    turn = 2.0 * np.pi * np.arange(1024) / 1024
    total = np.zeros(turn.size)
    for planet in range(planets):
        angle = turn + 2.0 * np.pi * planet / planets
        first = held.reactions(mesh.at(angle))[0]
        total += first * np.cos(order * angle)
    spectrum = 2.0 * np.abs(np.fft.rfft(total)) / turn.size
    near = np.arange(order - 12, order + 13)
    vanish = near[near % planets != 0]
    assert spectrum[vanish] == pytest.approx(np.zeros(vanish.size), abs=1e-12)
    assert spectrum[lines.order] == pytest.approx(lines.amplitude[0], rel=1e-3)


def test_a_fit_all_around_has_no_lugs_and_no_lines():
    lines = side_lines(HeldRing(ring_of(0.12), FIT), mesh_port(ring_of(0.12), np.zeros(1)), 96, 3, 12)
    assert lines.amplitude.shape == (0, lines.order.size)
