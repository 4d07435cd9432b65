"""Random feasible ring gears are meshed within the quality limits, in the plane and as sectors."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from fe_contact.errors import InputError
from fe_contact.geometry import RingGear
from fe_contact.mesh import SectorRecipe, mesh_gear, mesh_quality, quad_sector
from fe_contact.mesh.quality import quad_quality


@pytest.mark.law
@settings(max_examples=12, suppress_health_check=[HealthCheck.filter_too_much])
@given(
    teeth=st.integers(30, 200),
    module=st.floats(0.2e-3, 40e-3),
    shift=st.floats(-0.8, 0.3),
    pressure_angle=st.floats(14.5, 28.0),
    helix=st.floats(-35.0, 35.0),
    rim=st.floats(0.3, 15.0),
    addendum=st.floats(0.5, 1.0),
    rounding=st.floats(0.0, 0.25),
    cutter=st.integers(12, 30),
    level=st.sampled_from(["draft", "standard", "fine"]),
)
def test_mesh_of_a_random_ring_gear_is_good(
    teeth: int,
    module: float,
    shift: float,
    pressure_angle: float,
    helix: float,
    rim: float,
    addendum: float,
    rounding: float,
    cutter: int,
    level: str,
) -> None:
    numbers = {
        "teeth": teeth,
        "normal_module": module,
        "face_width": 6.0 * module,
        "normal_pressure_angle": np.radians(pressure_angle),
        "helix_angle": np.radians(helix),
        "profile_shift_coefficient": shift,
        "addendum_coefficient": addendum,
        "root_radius_coefficient": rounding,
        "cutter_teeth": cutter,
    }
    try:
        root = RingGear(**numbers, rim_diameter=3.0 * teeth * module).root_radius
        gear = RingGear(**numbers, rim_diameter=2.0 * (root + rim * module))
    except InputError:
        assume(False)
    mesh = mesh_gear(gear)
    for part in (mesh.sector, mesh.hub):
        if part is not None:
            quality = mesh_quality(part.points, part.triangles)
            assert quality.scaled_jacobian.min() >= 0.2
            assert quality.angle.min() >= np.radians(12.0)
    assert np.linalg.norm(mesh.points[mesh.bore_nodes], axis=1) == pytest.approx(gear.held_radius)
    section = quad_sector(gear, getattr(SectorRecipe, level)(gear))
    sector_quality = quad_quality(section.points, section.grid.quads)
    assert sector_quality.angle.min() >= np.radians(15.0)
    assert sector_quality.scaled_jacobian.min() >= 0.1
