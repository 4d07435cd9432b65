"""A geared rotor with unbalances against an independent rotordynamics code.

The turbo-alternator of Rao, Shiau and Chang (1998). The two rotors are those of ross-rotordynamics 2.3.0:
Timoshenko elements of 60 mm at most, discs, bearings and gyroscopic matrices at both speeds, the turbine
turning backwards. The mesh and the drive's spring were added to its matrices as k g g^T, and the response to
each unbalance solved for.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from dynamics.assembly.assemble import assemble
from dynamics.linearize import ForcedResponse, forced_response
from lineofaction.gearbox.convert.scene import dynamic_scene
from lineofaction.gearbox.subjects import scene_of

EXAMPLE = Path(__file__).parents[3] / "examples" / "geared_rotor_scene.toml"
TEETH = (328, 23)
SPEEDS = (15.0, 60.0, 157.0)
BY_ROSS = {
    # unbalance, rad/s of the generator: forces on the ground in x and y at the four bearings, mesh force, N
    ("generator", 15.0): (
        2.214688e00 - 1.405647e-05j,
        1.251400e-05 - 2.214368e00j,
        4.321152e-02 + 2.437921e-04j,
        -2.505522e-04 - 4.261467e-02j,
        1.041541e-04 - 2.452503e-04j,
        2.502487e-04 - 5.892564e-04j,
        -6.022473e-06 + 1.414932e-05j,
        -1.496091e-05 + 3.525062e-05j,
        2.567346e-04 - 6.045062e-04j,
    ),
    ("generator", 60.0): (
        3.710406e01 - 1.129870e-04j,
        -2.334533e-03 - 3.698995e01j,
        1.538378e00 - 1.362884e-02j,
        1.293049e-02 - 1.518521e00j,
        -4.743686e-03 + 1.242222e-02j,
        -1.086070e-02 + 2.531556e-02j,
        1.466189e-03 - 2.185411e-03j,
        3.469431e-03 - 8.408996e-03j,
        -1.375267e-02 + 3.231978e-02j,
    ),
    ("generator", 157.0): (
        2.321762e02 - 3.009585e00j,
        6.754715e-01 - 2.391200e02j,
        -3.760513e01 - 2.602877e01j,
        2.944590e00 - 2.688862e01j,
        -3.180495e-01 + 2.900730e01j,
        -1.490727e00 + 5.101538e01j,
        -3.935169e-01 - 3.687072e00j,
        -4.207386e-02 + 3.397102e00j,
        -1.615235e00 + 4.438675e01j,
    ),
    ("turbine", 15.0): (
        -6.576631e-01 + 4.170931e-01j,
        -1.776225e00 + 8.914303e-01j,
        -8.061773e00 + 4.374535e00j,
        -1.888821e01 + 9.851664e00j,
        -1.126681e01 + 4.270628e00j,
        1.292350e01 - 7.677743e00j,
        2.067995e01 - 6.743220e00j,
        1.075727e00 + 4.729334e00j,
        1.095597e01 - 5.730491e00j,
    ),
    ("turbine", 60.0): (
        1.744586e01 + 1.093710e01j,
        -7.445376e00 + 2.890291e01j,
        -1.999980e01 - 2.106593e00j,
        7.586008e00 - 4.837545e00j,
        -4.233734e-01 - 2.769077e01j,
        2.549584e01 - 6.608301e01j,
        -2.364979e01 - 5.675084e01j,
        -9.060132e00 + 3.546041e02j,
        -9.971560e-01 + 1.389836e02j,
    ),
    ("turbine", 157.0): (
        -6.461591e-02 - 2.341215e00j,
        -1.006573e00 - 6.083854e00j,
        1.540544e00 + 9.618823e00j,
        3.676178e00 + 2.541695e01j,
        5.480201e00 - 8.708732e00j,
        -3.440267e00 - 8.321569e01j,
        -2.260824e01 - 2.981061e01j,
        2.831407e01 - 2.327800e02j,
        1.052303e02 + 5.760507e02j,
    ),
}


@pytest.fixture(scope="module")
def response() -> ForcedResponse:
    """Return the response up to the first order of the mesh, in which both shafts' orders lie."""
    return forced_response(assemble(dynamic_scene(scene_of(EXAMPLE)[0], {})), SPEEDS, orders=1)


@pytest.mark.parametrize(("unbalance", "speed"), BY_ROSS)
def test_bearing_and_mesh_forces_are_those_of_ross(
    response: ForcedResponse, unbalance: str, speed: float
) -> None:
    """Complex amplitudes within 0.1 %, each of them; the mesh carries order 1 of either shaft."""
    assert response.order == pytest.approx([1.0 / TEETH[0], 1.0 / TEETH[1]])
    order, at = ("generator", "turbine").index(unbalance), SPEEDS.index(speed)
    forces = response.bearing_force[:, :2, at, order].ravel()
    found = np.array([*forces, response.mesh_force[0, at, order]])
    assert found == pytest.approx(np.array(BY_ROSS[unbalance, speed]), rel=1e-3)
