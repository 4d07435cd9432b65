"""Random feasible gears have good tooth sectors in three dimensions, or are refused by the geometry."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from fe_contact.errors import InputError
from fe_contact.geometry import Gear
from fe_contact.mesh import SectorRecipe, quad_sector, swept_sector
from fe_contact.mesh.quality import quad_quality


@pytest.mark.law
@settings(max_examples=15, suppress_health_check=[HealthCheck.filter_too_much])
@given(
    teeth=st.integers(5, 120),
    module=st.floats(0.2e-3, 40e-3),
    shift=st.floats(-0.5, 0.8),
    pressure_angle=st.floats(14.5, 28.0),
    helix=st.floats(-45.0, 45.0),
    bore=st.floats(0.05, 0.97),
    width=st.floats(1.0, 30.0),
    root_radius=st.floats(0.1, 0.45),
    level=st.sampled_from(["draft", "standard", "fine", "even_load"]),
)
def test_sector_of_a_random_gear_is_good(
    teeth: int,
    module: float,
    shift: float,
    pressure_angle: float,
    helix: float,
    bore: float,
    width: float,
    root_radius: float,
    level: str,
) -> None:
    numbers = {
        "teeth": teeth,
        "normal_module": module,
        "face_width": width * module,
        "normal_pressure_angle": np.radians(pressure_angle),
        "helix_angle": np.radians(helix),
        "profile_shift_coefficient": shift,
        "root_radius_coefficient": root_radius,
    }
    try:
        root = Gear(**numbers, bore_diameter=1e-3 * module).root_radius
        gear = Gear(**numbers, bore_diameter=2.0 * bore * root)
    except InputError:
        assume(False)
    recipe = getattr(SectorRecipe, level)(gear)
    section = quad_sector(gear, recipe)
    quality = quad_quality(section.points, section.grid.quads)
    assert quality.angle.min() >= np.radians(15.0)
    assert quality.scaled_jacobian.min() >= 0.1
    assert section.s[-1] - section.s[0] > 0.5 * module
    sector = swept_sector(section.grid, gear.face_width, recipe)
    assert len(sector.left) == len(sector.right) > 0
    assert sector.flank_index.max() + 1 == len(sector.flank)
