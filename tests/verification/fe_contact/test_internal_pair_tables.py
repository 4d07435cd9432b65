"""Tables of internal pairs: kinematics, Hertz, scaling, mirror images, the rack that both kinds end in."""

import math
from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np
import pytest
from analysis_requests import point_request

from fe_contact.analysis.analyze import analyze
from fe_contact.analysis.flanks.flank_results import flank_results
from fe_contact.analysis.pairs.pair_contact import pair_contact
from fe_contact.contact import ContactModel
from fe_contact.effects.misalignment import MisalignmentGap
from fe_contact.geometry import Gear, GearPair, InternalGearPair, ParallelAxes, RingGear
from fe_contact.mesh import SectorRecipe
from fe_contact.options import AnalysisOptions
from fe_contact.planning.discretization import FaceDiscretization
from fe_contact.planning.plan import make_plan
from fe_contact.ste import SteDatabase

MODULE, WIDTH = 2e-3, 20e-3
PLANET = Gear(36, MODULE, WIDTH, bore_diameter=30e-3)
RING = RingGear(96, MODULE, WIDTH, rim_diameter=212e-3, addendum_coefficient=0.9)
PAIR = InternalGearPair(PLANET, RING)
SUN = GearPair(Gear(24, MODULE, WIDTH, bore_diameter=20e-3), PLANET)
TORQUES = (5.0, 60.0, 200.0)


@lru_cache(maxsize=8)
def table(pair: ParallelAxes, model: str = "plane_strain", **more: Any) -> SteDatabase:
    return analyze(pair, torques=TORQUES, level="draft", positions=16, model=model, **more)


def test_conjugate_flanks_have_no_error_without_load_at_any_center_distance():
    tight = replace(PAIR, center_distance=PAIR.center_distance - 20e-6)
    found = analyze(
        tight,
        torques=[60.0],
        level="draft",
        positions=8,
        model="plane_strain",
        center_distance_changes=[-1e-4, 0.0, 2e-5],
    )
    assert np.abs(found.no_load_transmission_error).max() < 1e-15
    assert found.geometry.internal
    assert found.geometry.center_distance * math.cos(found.geometry.working_pressure_angle) == pytest.approx(
        found.geometry.base_radius[1] - found.geometry.base_radius[0], rel=1e-14
    )


@pytest.mark.law
def test_planetary_set_has_finite_tables_that_keep_the_laws():
    """Sun 24, planet 36, ring 96: both meshes share the planet and the center distance."""
    assert SUN.center_distance == pytest.approx(PAIR.center_distance, rel=1e-12)
    for pair, model in ((SUN, "plane_strain"), (PAIR, "plane_strain"), (PAIR, "3d")):
        found = table(pair, model)
        assert np.all(found.status == 0)
        assert np.all(np.isfinite(found.static_transmission_error))
        assert found.residuals.max() < 1e-9
        assert found.load_share.sum(axis=-1) == pytest.approx(1.0, abs=1e-12)
        assert np.all(found.tangent_compliance > 0.0)
        assert np.all(np.diff(found.static_transmission_error, axis=1) > 0.0)
        assert found.pairs_in_contact.min() >= 1


def test_three_dimensions_exceed_plane_strain_as_they_do_in_external_pairs(record_figure):
    excess = max(
        table(PAIR, "3d").mean(torque=t).value / table(PAIR).mean(torque=t).value - 1.0 for t in TORQUES
    )
    record_figure("internal pair, mean STE over plane strain", excess, "0.02 to 0.03", "", "external pairs")
    assert 0.02 < excess < 0.03


def test_the_corrected_plane_stands_in_for_three_dimensions(record_figure):
    apart = max(
        abs(table(PAIR, "auto").mean(torque=t).value / table(PAIR, "3d").mean(torque=t).value - 1.0)
        for t in TORQUES
    )
    record_figure("internal pair, corrected plane over 3-D draft", apart, "at most 0.01", "", "two methods")
    assert apart < 0.01


def test_pressure_at_the_pitch_point_is_hertz_with_the_hollow_flank():
    found = flank_results(PAIR, *point_request(torque=60.0, level="draft", model="plane_strain"), at=[0.0])
    at = int(np.flatnonzero(found.pair == 0)[0])
    assert found.roll_length_2[0, at, 0] - found.roll_length_1[0, at, 0] == pytest.approx(
        PAIR.common_tangent, rel=1e-12
    )
    first, second = PAIR.operating_pitch_radii
    sine = math.sin(PAIR.working_pressure_angle)
    radius = 1.0 / (1.0 / (first * sine) - 1.0 / (second * sine))
    modulus = 0.5 * PLANET.material.plane_strain_modulus
    exact = math.sqrt(float(found.force[0, at, 0]) / WIDTH * modulus / (math.pi * radius))
    assert found.pressure[0, at, 0] == pytest.approx(exact, rel=1e-12)


def scaled(gear: Any, factor: float) -> Any:
    held = "rim_diameter" if isinstance(gear, RingGear) else "bore_diameter"
    lengths = ("normal_module", "face_width", held)
    return replace(gear, **{name: factor * getattr(gear, name) for name in lengths})


@pytest.mark.law
def test_lengths_by_s_and_forces_by_s_squared_scale_the_table():
    large = InternalGearPair(scaled(PLANET, 4.0), scaled(RING, 4.0))
    found = analyze(
        large, torques=[64.0 * t for t in TORQUES], level="draft", positions=16, model="plane_strain"
    )
    assert found.static_transmission_error == pytest.approx(
        4.0 * table(PAIR).static_transmission_error, rel=1e-8
    )
    assert found.max_pressure == pytest.approx(table(PAIR).max_pressure, rel=1e-8)


def helical(pair: InternalGearPair, angle: float, **more: Any) -> InternalGearPair:
    gears = (replace(gear, helix_angle=angle) for gear in (pair.pinion, pair.wheel))
    return InternalGearPair(*gears, **more)


def almost_a_rack(teeth: int, internal: bool) -> ParallelAxes:
    """Return a helical pinion with a large wheel whose teeth point outwards or inwards."""
    angle, tool = 0.3, {"root_radius_coefficient": 0.2, "addendum_coefficient": 0.9}
    pinion = Gear(24, MODULE, WIDTH, bore_diameter=25e-3, helix_angle=angle, **tool)
    across, rim = teeth * MODULE / math.cos(angle), 20.0 * MODULE
    if internal:
        cutter = {"cutter_teeth": int(0.8 * teeth)}
        ring = RingGear(teeth, MODULE, WIDTH, across + rim, helix_angle=angle, **tool, **cutter)
        return InternalGearPair(pinion, ring)
    return GearPair(pinion, Gear(teeth, MODULE, WIDTH, across - rim, helix_angle=-angle, **tool))


def misaligned(pair: ParallelAxes, growth: float = 20e-6) -> tuple[np.ndarray, np.ndarray]:
    """Deflection in m and load centroid over the face width at three positions, on coarse meshes."""
    model = ContactModel(couple_teeth=True, across_face=True, gaps=(MisalignmentGap(growth),))
    load = pair.normal_force([40.0])
    plan = make_plan(pair, load, AnalysisOptions(level="draft"), model)
    sizes = {"flank_size": 0.4, "tip_size": 0.2, "depth_size": 0.4, "depth_limit": 0.8}
    sizes |= {"body_size": 0.5, "body_limit": 2.0}
    recipe = SectorRecipe(
        **{name: part * MODULE for name, part in sizes.items()}, layers=6, merge_rows=(), land_elements=1
    )
    made = FaceDiscretization((recipe, recipe), (recipe, recipe), slices=11, max_slices=11)
    contact = pair_contact(pair, replace(plan, discretization=made), cache=None)
    problem, solution = contact.solve(model, np.array([0.3, 0.45, 0.6]), load)
    force, face = solution.force[:, 0], problem.candidates.face_position
    return solution.deflection[:, 0], force @ face / force.sum(axis=1) / WIDTH


@pytest.mark.law
def test_large_wheels_with_teeth_outwards_and_inwards_end_in_the_same_rack(record_figure):
    """What tells them apart falls with 1/z: curvature, tooth shape, rim. Hands and faces must agree."""
    apart, offset = np.empty((2, 2, 3))
    for i, teeth in enumerate((100, 300)):
        (outwards, at_1), (inwards, at_2) = (misaligned(almost_a_rack(teeth, kind)) for kind in (False, True))
        apart[i], offset[i] = np.abs(inwards / outwards - 1.0), np.abs(at_2 - at_1)
    worst = float(apart[1].max())
    record_figure("internal over external pair, 300 teeth", worst, "at most 0.08", "", "limit of a rack")
    assert np.all(apart[0] > 2.5 * apart[1])
    assert worst < 0.08
    assert np.all(offset[0] > 2.5 * offset[1])
    assert offset[1].max() < 3e-3


def test_opposite_hands_are_mirror_images():
    pairs = [
        InternalGearPair(*(replace(gear, helix_angle=angle) for gear in (PLANET, RING)))
        for angle in (0.25, -0.25)
    ]
    (right, at_1), (left, at_2) = (misaligned(*each) for each in zip(pairs, (15e-6, -15e-6), strict=True))
    assert left == pytest.approx(right, rel=1e-9)
    assert at_2 == pytest.approx(-at_1, rel=1e-9)
    assert np.abs(at_1).min() > 0.02
