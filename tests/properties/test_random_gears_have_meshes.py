"""Random feasible gears are meshed within the quality limits, or refused by the geometry."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from fe_contact.errors import InputError
from fe_contact.geometry import Gear
from fe_contact.mesh import mesh_gear, mesh_quality


@pytest.mark.law
@settings(max_examples=15, suppress_health_check=[HealthCheck.filter_too_much])
@given(
    teeth=st.integers(5, 120),
    module=st.floats(0.2e-3, 40e-3),
    shift=st.floats(-0.5, 0.8),
    pressure_angle=st.floats(14.5, 28.0),
    helix=st.floats(0.0, 35.0),
    bore=st.floats(0.05, 0.97),
    addendum=st.floats(0.8, 1.3),
    root_radius=st.floats(0.1, 0.45),
)
def test_mesh_of_a_random_gear_is_good(
    teeth: int,
    module: float,
    shift: float,
    pressure_angle: float,
    helix: float,
    bore: float,
    addendum: float,
    root_radius: float,
) -> None:
    numbers = {
        "teeth": teeth,
        "normal_module": module,
        "face_width": 6.0 * module,
        "normal_pressure_angle": np.radians(pressure_angle),
        "helix_angle": np.radians(helix),
        "profile_shift_coefficient": shift,
        "addendum_coefficient": addendum,
        "root_radius_coefficient": root_radius,
    }
    try:
        root = Gear(**numbers, bore_diameter=1e-3 * module).root_radius
        gear = Gear(**numbers, bore_diameter=2.0 * bore * root)
    except InputError:
        assume(False)
    mesh = mesh_gear(gear)
    for part in (mesh.sector, mesh.hub):
        if part is not None:
            quality = mesh_quality(part.points, part.triangles)
            assert quality.scaled_jacobian.min() >= 0.2
            assert quality.angle.min() >= np.radians(12.0)
    assert mesh.sector.s[0] <= mesh.sector.s[-1] - 0.5 * module
    assert np.linalg.norm(mesh.points[mesh.bore_nodes], axis=1) == pytest.approx(0.5 * gear.bore_diameter)
