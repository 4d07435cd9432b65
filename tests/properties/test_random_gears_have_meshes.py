"""Random feasible gears and ring gears have good meshes and tooth sectors, or are refused by the geometry."""

from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from fe_contact.errors import InputError
from fe_contact.geometry import Gear, RingGear
from fe_contact.mesh import SectorRecipe, mesh_gear, mesh_quality, quad_sector, swept_sector
from fe_contact.mesh.quality import quad_quality

EXTERNAL = {
    "teeth": st.integers(5, 120),
    "profile_shift_coefficient": st.floats(-0.5, 0.8),
    "root_radius_coefficient": st.floats(0.1, 0.45),
}
INTERNAL = {
    "teeth": st.integers(30, 200),
    "profile_shift_coefficient": st.floats(-0.8, 0.3),
    "root_radius_coefficient": st.floats(0.0, 0.25),
    "addendum_coefficient": st.floats(0.5, 1.0),
    "cutter_teeth": st.integers(12, 30),
}
BORE = st.floats(0.05, 0.97)
"""Of the root diameter."""


def sizes(
    fields: dict[str, st.SearchStrategy[Any]], helix: tuple[float, float], width: tuple[float, float]
) -> st.SearchStrategy[dict[str, Any]]:
    """Return fields of gears: the helix angle from and to degrees, the face width from and to modules."""

    def in_si(numbers):
        angles = {name: np.radians(numbers[name]) for name in ("normal_pressure_angle", "helix_angle")}
        return numbers | angles | {"face_width": numbers["face_width"] * numbers["normal_module"]}

    shared = {
        "normal_module": st.floats(0.2e-3, 40e-3),
        "normal_pressure_angle": st.floats(14.5, 28.0),
        "helix_angle": st.floats(*helix),
        "face_width": st.floats(*width),
    }
    return st.fixed_dictionaries(shared | fields).map(in_si)


def external(numbers: dict[str, Any], bore: float) -> Gear:
    try:
        root = Gear(**numbers, bore_diameter=1e-3 * numbers["normal_module"]).root_radius
        return Gear(**numbers, bore_diameter=2.0 * bore * root)
    except InputError:
        assume(False)
        raise


def internal(numbers: dict[str, Any], rim: float) -> RingGear:
    module = numbers["normal_module"]
    try:
        root = RingGear(**numbers, rim_diameter=3.0 * numbers["teeth"] * module).root_radius
        return RingGear(**numbers, rim_diameter=2.0 * (root + rim * module))
    except InputError:
        assume(False)
        raise


def check_mesh(gear: Gear | RingGear, seat_radius: float) -> Any:
    mesh = mesh_gear(gear)
    for part in (mesh.sector, mesh.hub):
        if part is not None:
            quality = mesh_quality(part.points, part.triangles)
            assert quality.scaled_jacobian.min() >= 0.2
            assert quality.angle.min() >= np.radians(12.0)
    assert np.linalg.norm(mesh.points[mesh.bore_nodes], axis=1) == pytest.approx(seat_radius)
    return mesh


def check_section(gear: Gear | RingGear, recipe: SectorRecipe) -> Any:
    section = quad_sector(gear, recipe)
    quality = quad_quality(section.points, section.grid.quads)
    assert quality.angle.min() >= np.radians(15.0)
    assert quality.scaled_jacobian.min() >= 0.1
    return section


@pytest.mark.law
@settings(max_examples=15, suppress_health_check=[HealthCheck.filter_too_much])
@given(
    sizes(EXTERNAL | {"addendum_coefficient": st.floats(0.8, 1.3)}, helix=(0.0, 35.0), width=(6.0, 6.0)), BORE
)
def test_mesh_of_a_random_gear_is_good(numbers, bore):
    gear = external(numbers, bore)
    mesh = check_mesh(gear, 0.5 * gear.bore_diameter)
    assert mesh.sector.s[0] <= mesh.sector.s[-1] - 0.5 * gear.normal_module


@pytest.mark.law
@settings(max_examples=15, suppress_health_check=[HealthCheck.filter_too_much])
@given(
    sizes(EXTERNAL, helix=(-45.0, 45.0), width=(1.0, 30.0)),
    BORE,
    st.sampled_from(["draft", "standard", "fine", "even_load"]),
)
def test_sector_of_a_random_gear_is_good(numbers, bore, level):
    gear = external(numbers, bore)
    recipe = getattr(SectorRecipe, level)(gear)
    section = check_section(gear, recipe)
    assert section.s[-1] - section.s[0] > 0.5 * gear.normal_module
    sector = swept_sector(section.grid, gear.face_width, recipe)
    assert len(sector.left) == len(sector.right) > 0
    assert sector.flank_index.max() + 1 == len(sector.flank)


@pytest.mark.law
@settings(max_examples=12, suppress_health_check=[HealthCheck.filter_too_much])
@given(
    sizes(INTERNAL, helix=(-35.0, 35.0), width=(6.0, 6.0)),
    st.floats(0.3, 15.0),
    st.sampled_from(["draft", "standard", "fine"]),
)
def test_mesh_of_a_random_ring_gear_is_good(numbers, rim, level):
    gear = internal(numbers, rim)
    check_mesh(gear, gear.seat_radius)
    check_section(gear, getattr(SectorRecipe, level)(gear))


def test_a_root_land_too_short_for_an_element_is_part_of_its_neighbor():
    """A nearly sharp root and a margin that reaches down to it: the land is 7 um long, elements 1.5 mm."""
    numbers = {"teeth": 30, "normal_module": 31.25e-3, "face_width": 187.5e-3, "cutter_teeth": 13}
    numbers |= {"normal_pressure_angle": 0.4526947747360292, "root_radius_coefficient": 0.00390625}
    gear = RingGear(**numbers, rim_diameter=1.078125)
    check_mesh(gear, gear.seat_radius)
