"""What Exudyn is handed: forces that balance, and the derivatives that belong to them."""

import numpy as np
import pytest
from geared_scenes import BASE_RADIUS
from mesh_elements import helical_element

from benchmarks.exudyn_scene import PlanarMesh, user_functions
from dynamics.meshes.flank_force import FlankLaws, flank_force
from dynamics.meshes.packed_tables import pack_tables

ANGLE = np.radians(20.0)


@pytest.fixture
def element():
    return helical_element()


@pytest.fixture
def rng():
    return np.random.default_rng(11)


@pytest.fixture(params=[1, -1], ids=["forwards", "backwards"])
def mesh(request, element):
    """The driver below at the origin, the driven gear on +x at the center distance."""
    direction = (float(np.sin(ANGLE)), float(request.param * np.cos(ANGLE)))
    return PlanarMesh(element, direction, request.param)


def states(mesh, rng):
    """Some in full contact, some where the damping fades, some that part; the angles are large."""
    for d in (6e-6, 2e-7, -1e-6, *rng.uniform(-1e-6, 1e-5, 20)):
        q = np.concatenate([rng.uniform(-1e-6, 1e-6, 2), [3.0], rng.uniform(-1e-6, 1e-6, 2), [0.0]])
        q[5] = (d - mesh.gradient[:5] @ q[:5]) / mesh.gradient[5]
        yield q, rng.uniform(-1e-3, 1e-3, 6)


@pytest.mark.law
def test_forces_balance_about_every_point(mesh, rng):
    """Action and reaction on one line through the pitch point: no net force, no net moment."""
    force, _ = user_functions(mesh)
    distance, loaded = 2.5 * BASE_RADIUS / np.cos(ANGLE), 0
    for q, v in states(mesh, rng):
        x1, y1, t1, x2, y2, t2 = force(None, 0.0, 0, q, v)
        assert (x1 + x2, y1 + y2) == (0.0, 0.0)
        assert t1 + t2 + distance * y2 == pytest.approx(0.0, abs=1e-12 * max(abs(t1), 1e-9))
        assert t1 * mesh.sense <= 0.0  # against the driver's motion
        loaded += t1 != 0.0
    assert 10 < loaded < 23


def test_the_jacobian_is_that_of_the_force(mesh, rng):
    force, jacobian = user_functions(mesh)
    slope_of_position = 0.0
    for q, v in states(mesh, rng):
        for h, stiff, viscous in ((1e-12, 1.0, 0.0), (1e-7, 0.0, 1.0)):
            found = jacobian(None, 0.0, 0, q, v, stiff, viscous)
            for k in (0, 1, 3, 4, 5):  # not the driver's angle, which moves the position too
                ends = [
                    force(None, 0.0, 0, q + s * h * stiff * np.eye(6)[k], v + s * h * viscous * np.eye(6)[k])
                    for s in (1.0, -1.0)
                ]
                column = -(ends[0] - ends[1]) / (2.0 * h)
                scale = max(np.abs(found).max(), 1.0)
                np.testing.assert_allclose(found[:, k], column, rtol=0.0, atol=5e-3 * scale)
            slope_of_position = max(slope_of_position, np.abs(found).max())
    assert slope_of_position > 0.0


def test_a_drive_replaces_the_coordinate(mesh, rng):
    """The same angle and speed as a function of time."""
    free, _ = user_functions(mesh)
    for q, v in states(mesh, rng):
        driven, jacobian = user_functions(mesh, lambda t, a=q[2], w=v[2]: (a + 0.0 * t, w))
        keep = [0, 1, 3, 4, 5]
        expected = free(None, 0.0, 0, q, v)[keep]
        np.testing.assert_allclose(driven(None, 0.0, 0, q[keep], v[keep]), expected, rtol=1e-9, atol=1e-9)
        assert jacobian(None, 0.0, 0, q[keep], v[keep], 1.0, 1.0).shape == (5, 5)


def test_the_position_counts_in_the_drivers_own_sense(mesh, element):
    """At an angle of its own sense both ways round give the force of that position."""
    law = FlankLaws(pack_tables([element.table]), np.array([element.damping]), np.array([element.reach]))
    for angle in (0.1, 0.2, 3.0):
        q = np.zeros(6)
        q[2] = mesh.sense * angle
        q[5] = (6e-6 - mesh.gradient[2] * q[2]) / mesh.gradient[5]
        expected = flank_force(law, 0, 0.3 + 20 * angle / (2.0 * np.pi), 6e-6, 0.0, 0)[0]
        found = user_functions(mesh)[0](None, 0.0, 0, q, np.zeros(6))
        assert found[2] == pytest.approx(-mesh.sense * expected * BASE_RADIUS, rel=1e-9)
