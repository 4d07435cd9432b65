"""The ending of a name states its unit, which one table knows."""

from itertools import pairwise

import pytest

from lineofaction.gearbox.units import UNITS, ending_of, factor, unit_of
from lineofaction.report.drawing.tables import settings_table


def test_an_ending_stands_before_those_that_it_ends_with():
    assert all(ending_of(f"name{ending}") == ending for ending in UNITS)
    assert not [(first, second) for first, second in pairwise(UNITS) if second.endswith(first)]


def test_only_units_beside_those_of_si_have_a_factor():
    assert factor("housings[0].position_mm") == 1e-3 and factor("line.stiffness_n_per_m") == 1.0
    assert unit_of("torque_n_m") is None and unit_of("imbalance_g_mm") == UNITS["_g_mm"]


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("stiffness_n_per_um", "stiffness, N/µm"),
        ("surface_mm_per_s", "surface, mm/s"),
        ("damping_n_m_s_per_rad", "damping, N m s/rad"),
        ("inertia_kg_m2", "inertia, kg m²"),
        ("helix_angle_deg", "helix angle, °"),
        ("name", "name"),
    ],
)
def test_a_fact_of_a_report_has_its_unit_after_its_words(name, words):
    assert settings_table("", {name: 1.0}).rows == ((words, "1"),)
