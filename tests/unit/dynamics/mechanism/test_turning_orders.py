"""By which orders what turns repeats: meshes, gears against their carrier, shafts."""

import pytest
from planetary_scenes import planetary_scene, published_set

from bounds import order_name
from dynamics.mechanism.kinematics import solve_kinematics
from dynamics.mechanism.passing import turning_orders


def test_gears_of_a_planetary_set_turn_against_their_carrier():
    """One tooth of each in a period of mesh; the sun's shaft turns once in 1 + z_s/z_r of its turns there."""
    gears = published_set(3)
    sun, planet, ring = gears.teeth
    scene = planetary_scene(gears)
    turning = turning_orders(scene, solve_kinematics(scene))
    orders, whole = turning["shaft"], 1.0 + sun / ring
    assert all(order == pytest.approx(1.0, rel=1e-12) for order in turning["mesh"].values())
    by_teeth = {
        name: 1.0 / scene.gear(name).teeth for mesh in scene.meshes for name in (mesh.driver, mesh.driven)
    }
    assert {name: orders[name] for name in by_teeth} == pytest.approx(by_teeth, rel=1e-12)
    assert orders["carrier"] == pytest.approx((whole - 1.0) / sun, rel=1e-12)
    assert order_name(2.0 - 1.0 / planet, **turning).endswith("2 - planet 1 1")
