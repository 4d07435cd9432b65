"""Forces in a state and their derivatives: against finite differences, through all elements."""

import numpy as np
import pytest
from geared_scenes import gear_pair_scene, square_wave_table, with_gear, with_mesh

from dynamics.assembly.assemble import assemble
from dynamics.meshes import CoastFlank
from dynamics.motion.force_balance import force_balance


def helical_pair():
    scene = with_mesh(gear_pair_scene(square_wave_table()), coast=CoastFlank(4e-6))
    return assemble(with_gear(with_gear(scene, 0, base_helix_angle=0.3), 1, base_helix_angle=-0.3))


@pytest.mark.parametrize("lag", [6e-6, -9e-6, -2e-6], ids=["driving", "coasting", "apart"])
def test_stiffness_and_damping_are_minus_the_derivatives(lag):
    system = helical_pair()
    arrays, n = system.arrays, len(system.freedoms.name)
    rng = np.random.default_rng(3)
    g = arrays.direction[0]
    q = g * lag / (g @ g) + 1e-8 * rng.standard_normal(n) / arrays.scale
    v = 1e-3 * rng.standard_normal(n) / arrays.scale
    external = rng.standard_normal(n)

    def force(q, v):
        return force_balance(arrays, 0.0, q, v, external).force

    found = force_balance(arrays, 0.0, q, v, external)
    touching = found.local.force > 0.0
    assert touching.tolist() == {6e-6: [True, False], -9e-6: [False, True], -2e-6: [False, False]}[lag]
    for matrix, about, step in ((found.stiffness, 0, 1e-11), (found.damping, 1, 1e-6)):
        for i in range(n):
            shift = np.zeros(n)
            shift[i] = step / arrays.scale[i]
            up, down = [(q, v)] * 2
            up = (q + shift, v) if about == 0 else (q, v + shift)
            down = (q - shift, v) if about == 0 else (q, v - shift)
            slope = (force(*up) - force(*down)) / (2.0 * shift[i])
            # turning the driver moves the position too, which the derivative leaves out
            limit = 2e-3 * np.max(np.abs(matrix[:, i])) + 1e-9
            np.testing.assert_allclose(matrix[:, i], -slope, rtol=0.0, atol=limit)


def test_only_the_flank_in_contact_acts():
    system = helical_pair()
    arrays = system.arrays
    g = arrays.direction[0]
    apart = force_balance(arrays, 0.0, -2e-6 * g / (g @ g), np.zeros(g.size), np.zeros(g.size))
    np.testing.assert_array_equal(apart.local.force, 0.0)
    np.testing.assert_array_equal(apart.stiffness, arrays.stiffness)
    np.testing.assert_array_equal(apart.damping, arrays.damping)
