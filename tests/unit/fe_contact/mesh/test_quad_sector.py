"""The transverse section of a tooth sector: exact profile, matching cuts, good elements on odd gears."""

import math
from typing import Any

import numpy as np
import pytest

from fe_contact.errors import MeshError
from fe_contact.geometry import Gear, RingGear, Toothing, tooth_profile
from fe_contact.mesh import QualityLimits, SectorRecipe, quad_sector
from fe_contact.mesh.quality import quad_quality
from fe_contact.mesh.sector_grid import SectorGrid


def gear(teeth: int = 20, module: float = 4e-3, bore: float = 40e-3, **fields: Any) -> Gear:
    return Gear(teeth=teeth, normal_module=module, face_width=25e-3, bore_diameter=bore, **fields)


def ring(teeth: int = 60, module: float = 4e-3, rim: float = 280e-3, **fields: Any) -> RingGear:
    return RingGear(teeth=teeth, normal_module=module, face_width=25e-3, rim_diameter=rim, **fields)


ODD: dict[str, Toothing] = {
    "20 teeth": gear(),
    "6 teeth": gear(6, bore=5e-3, profile_shift_coefficient=0.5, helix_angle=0.4),
    "9 teeth": gear(9, bore=10e-3, profile_shift_coefficient=0.4),
    "undercut": gear(12, bore=20e-3),
    "deep waist": gear(7, bore=3e-3, profile_shift_coefficient=-0.3, root_radius_coefficient=0.15),
    "no bore to speak of": gear(9, bore=1e-3, profile_shift_coefficient=0.4),
    "thin rim": gear(40, bore=142e-3),
    "hardly a rim": gear(40, bore=148e-3),
    "a sleeve": gear(40, bore=149.4e-3),
    "high teeth": gear(
        40, 3e-3, 60e-3, addendum_coefficient=1.25, dedendum_coefficient=1.5, root_radius_coefficient=0.25
    ),
    "pressure angle 25": gear(
        30, 3e-3, 30e-3, normal_pressure_angle=math.radians(25.0), root_radius_coefficient=0.31
    ),
    "helix 45": gear(25, 3e-3, 30e-3, helix_angle=math.radians(45.0)),
    "300 teeth, deep": gear(300, 2e-3, 10e-3),
    "ring": ring(),
    "ring, hardly a rim": ring(rim=252e-3),
    "ring, a thick rim": ring(rim=500e-3),
    "small ring": ring(30, rim=150e-3, cutter_teeth=15, addendum_coefficient=0.6),
    "helical ring with sharp roots": ring(200, 2e-3, 500e-3, helix_angle=0.5, root_radius_coefficient=0.05),
}


@pytest.mark.drawn
@pytest.mark.parametrize("name", ODD)
def test_elements_of_odd_gears_are_good(name):
    for recipe in (SectorRecipe.draft(ODD[name]), SectorRecipe.fine(ODD[name])):
        section = quad_sector(ODD[name], recipe)
        quality = quad_quality(section.points, section.grid.quads)
        assert quality.angle.min() > math.radians(18.0)
        assert quality.scaled_jacobian.min() > 0.15
        assert len(section.grid.quads) < 700


@pytest.mark.parametrize("name", ["20 teeth", "undercut", "helix 45", "ring"])
def test_nodes_are_on_the_exact_outline(name):
    profile, recipe = tooth_profile(ODD[name]), SectorRecipe.standard(ODD[name])
    section = quad_sector(ODD[name], recipe)
    grid, points, s = section.grid, section.points, section.s
    assert np.array_equal(points[grid.flank], profile.flank(s))
    assert np.array_equal(section.normals, profile.normal(s))
    assert s[1::2] == pytest.approx(0.5 * (s[:-2:2] + s[2::2]), rel=1e-15)
    assert s[-1] == profile.s_tip
    split = profile.s_form - recipe.split * profile.fillet_length
    assert s[0] == pytest.approx(split) if name != "undercut" else profile.s_root < s[0] < split
    assert ODD[name].sign * section.normals[0, 1] >= 0.4 - 1e-9
    assert np.min(np.abs(s[::2] - profile.s_form)) < 1e-15
    assert np.linalg.norm(points[grid.bore], axis=1) == pytest.approx(ODD[name].seat_radius, rel=1e-14)
    tip = points[grid.number[-1][grid.number[-1] >= 0]]
    assert np.linalg.norm(tip, axis=1) == pytest.approx(ODD[name].tip_radius, rel=1e-14)
    coast = grid.number[2 * grid.body_rows :, 2 * (grid.land + grid.across)]
    assert np.array_equal(points[coast], points[grid.flank] * [-1.0, 1.0])


@pytest.mark.parametrize("name", ["20 teeth", "ring"])
def test_the_left_cut_turned_by_a_pitch_is_the_right_one(name):
    section = quad_sector(ODD[name], SectorRecipe.draft(ODD[name]))
    left, right = section.points[section.grid.left], section.points[section.grid.right]
    angle = 2.0 * np.pi / ODD[name].teeth
    turned = left @ np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    assert turned == pytest.approx(right, abs=1e-16)


@pytest.mark.parametrize("subject", [gear(17, bore=30e-3), ring(50, rim=230e-3)], ids=["gear", "ring"])
def test_the_section_has_the_area_of_the_gear(subject):
    """By Green's theorem along the exact outline of one pitch; elements counter-clockwise."""
    section = quad_sector(subject, SectorRecipe.fine(subject))
    profile, half = tooth_profile(subject), np.pi / subject.teeth
    s = np.linspace(profile.s_space, profile.s_tip, 20001)
    x, y = profile.flank(s).T
    exact = float(np.sum(x[:-1] * y[1:] - x[1:] * y[:-1]))  # both flanks, from the root up
    exact += profile.tip_angle * subject.tip_radius**2 - half * subject.seat_radius**2
    quads = section.grid.quads
    ring = quads[:, [0, 4, 1, 5, 2, 6, 3, 7]]
    a, m, b = (section.points[ring[:, (np.arange(4) * 2 + i) % 8]] for i in range(3))

    def cross(p, q):
        return float(np.sum(p[..., 0] * q[..., 1] - p[..., 1] * q[..., 0]))

    assert (4 * cross(a, m) + 4 * cross(m, b) - cross(a, b)) / 6.0 == pytest.approx(
        subject.sign * exact, rel=5e-6
    )  # sides are parabolas


def test_quality_of_known_quadrilaterals_and_a_poor_element_is_named():
    with pytest.raises(MeshError, match=r"sector section: element \d+ at .* mm: corner angle"):
        quad_sector(gear(), SectorRecipe.draft(gear()), QualityLimits(angle=math.radians(80.0)))
    corners = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]])
    middles = 0.5 * (corners + np.roll(corners, -1, axis=0))
    slant = np.concatenate([corners, middles]) @ np.array([[1.0, 0.0], [1.0, 1.0]])
    folded = np.concatenate([corners, middles])
    folded[2] = [0.3, 0.2]
    folded[[5, 6]] = 0.5 * (folded[[1, 2]] + folded[[2, 3]])
    points = np.concatenate([np.concatenate([corners, middles]), slant, folded])
    quality = quad_quality(points, np.arange(24).reshape(3, 8))
    assert np.degrees(quality.angle[:2]) == pytest.approx([90.0, 45.0])
    kite = np.array([[0.0, 0.0], [1.0, -1.0], [2.0, 0.0], [1.0, 0.1]])
    kite = np.concatenate([kite, 0.5 * (kite + np.roll(kite, -1, axis=0))])
    flat = quad_quality(kite, np.arange(8)[None])
    assert flat.angle[0] == pytest.approx(2.0 * np.arctan(0.1))  # what the blunt corner lacks to 180 degrees
    assert quality.scaled_jacobian[:2] == pytest.approx([1.0, 1.0])
    assert quality.scaled_jacobian[2] < 0.0


def test_grid_is_a_t_of_conforming_quadrilaterals():
    grid = SectorGrid(body_rows=3, tooth_rows=4, land=2, across=5)
    assert len(grid.quads) == 3 * 9 + 4 * 5
    assert grid.nodes == grid.corner.sum() + len(
        {tuple(sorted(q[[i, (i + 1) % 4]])) for q in grid.quads for i in range(4)}
    )
    middles, count = np.unique(grid.quads[:, 4:], return_counts=True)
    assert not grid.corner[middles].any()
    assert set(middles[count == 1]) >= set(grid.left[1::2]) | set(grid.right[1::2]) | set(grid.bore[1::2])
    assert set(grid.cells[:, 1]) == set(range(-3, 4))
    assert len(grid.left) == len(grid.right) == 7
    assert len(grid.flank) == 9
