"""Line contact against published and recomputed numbers (units of the tables: N, mm, MPa, um)."""

import math

import pytest
from hertz_laws import two_cylinder_approach

from fe_contact.hertz import contact_modulus, half_width, peak_pressure, relative_radius
from fe_contact.material import Material

STEEL_206 = Material(youngs_modulus=206e9, poissons_ratio=0.3)


def test_nafems_cylinder_on_plane(record_figure):
    # NAFEMS/FENET D3613: R 50 mm, E 70/210 GPa, nu 0.3, 35 kN per mm of length
    modulus = contact_modulus(Material(70e9, 0.3), Material(210e9, 0.3))
    radius = relative_radius(50e-3, math.inf)
    width, pressure = half_width(35e6, radius, modulus), peak_pressure(35e6, radius, modulus)
    assert 1e3 * width == pytest.approx(6.21463, abs=5e-6)
    assert 1e-6 * pressure == pytest.approx(3585.36, abs=5e-3)
    record_figure("half-width, cylinder on plane", 1e3 * float(width), 6.21463, "mm", "NAFEMS D3613")
    record_figure("peak pressure, cylinder on plane", 1e-6 * float(pressure), 3585.36, "MPa", "NAFEMS D3613")


@pytest.mark.parametrize(
    ("radii", "load", "width", "pressure", "approach"),
    [
        ((25.0, 25.0), 100.0, 0.11858019, 536.86856, 3.508193),
        ((25.0, 25.0), 1000.0, 0.37498349, 1697.72746, 28.606476),
        ((12.5, 25.0), 100.0, 0.09682032, 657.52702, 3.427289),
    ],
)
def test_two_cylinders(radii, load, width, pressure, approach):
    # E 206 GPa, nu 0.3 both; approach center to center, Johnson (1985) section 5.6
    r1, r2 = (1e-3 * r for r in radii)
    radius, modulus = relative_radius(r1, r2), contact_modulus(STEEL_206, STEEL_206)
    assert 1e3 * half_width(1e3 * load, radius, modulus) == pytest.approx(width, abs=6e-9)
    assert 1e-6 * peak_pressure(1e3 * load, radius, modulus) == pytest.approx(pressure, abs=6e-6)
    found = two_cylinder_approach(1e3 * load, (r1, r2), (STEEL_206, STEEL_206))
    assert 1e6 * found == pytest.approx(approach, abs=6e-7)


def test_peak_pressure_of_the_20_20_pair(record_figure):
    # full contact of the 20/20 pair at 100 N m: Hertz 755.9 MPa at the pitch point, line load 106.42 N/mm
    steel = Material(210e9, 0.3)
    roll = 40e-3 * math.sin(math.radians(20.0))
    pressure = 1e-6 * float(
        peak_pressure(106.42e3, relative_radius(roll, roll), contact_modulus(steel, steel))
    )
    assert pressure == pytest.approx(755.9, rel=5e-4, abs=0.0)
    record_figure(
        "Hertz pressure at the pitch point, 20/20, 100 N m", pressure, 755.9, "MPa", "full FE contact"
    )
