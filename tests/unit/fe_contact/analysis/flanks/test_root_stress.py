"""Root stress of a pair: linear in the forces, mirror images, scaling, plane against face, peaks."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from analysis_requests import point_request, table_request
from numpy.typing import ArrayLike
from spur_gears import GEAR

from fe_contact import Gear, GearPair, InternalGearPair, RingGear, RootStress, Run, root_stress
from fe_contact.analysis.flanks import root_stress as root_module
from fe_contact.analysis.flanks.root_meshes import finer_root
from fe_contact.analysis.flanks.root_stress import pair_histories, stress_seconds, unit_stresses
from fe_contact.analysis.flanks.root_stress_history import crest_values
from fe_contact.analysis.flanks.solved_operating_point import solve_operating_point
from fe_contact.analysis.request.request_check import check_request
from fe_contact.analysis.request.solved_run import SolvedOperatingPoint
from fe_contact.compliance import unit_root_stress, unit_root_stress_3d
from fe_contact.mesh import MeshRecipe, SectorRecipe
from fe_contact.microgeometry.root_influence import RootInfluence
from model_studies.stage_clock import StageClock

FORCE = 2000.0
SPUR = GearPair(GEAR, GEAR, 80e-3)
PINION = Gear(19, 3e-3, 6e-3, 30e-3, helix_angle=math.radians(20.0))
HELICAL = GearPair(PINION, replace(PINION, teeth=26, helix_angle=-PINION.helix_angle))
NO_CORNERS = {"corner_contact": "off"}


@pytest.fixture(scope="module")
def cache(tmp_path_factory):
    return tmp_path_factory.mktemp("compliance")


def solved(
    pair: GearPair | InternalGearPair, cache: Path, at: ArrayLike | None = None, **options: object
) -> RootStress:
    options = {"normal_force": FORCE, "level": "draft"} | options
    return root_stress(pair, *point_request(**options), run=Run(cache=cache), at=at)


def place(pair: GearPair, cache: Path, model: str) -> SolvedOperatingPoint:
    checked = check_request(pair, *table_request(normal_forces=[FORCE], level="draft", model=model))
    return solve_operating_point(checked, np.array([0.1, 0.45, 0.8]), StageClock(), Run(cache=cache))


@pytest.mark.parametrize(("pair", "different"), [(SPUR, 1), (HELICAL, 2)])
def test_a_prediction_has_each_stress_on_both_meshes_until_it_is_kept(pair, different, tmp_path, monkeypatch):
    monkeypatch.setattr(root_module, "body_seconds", lambda *_: 1.0)
    contact = place(pair, tmp_path, "auto" if pair is SPUR else "3d").contact
    each = stress_seconds(pair, contact.plan, None) / (2 * different)
    assert each in (1.0, root_module._STRESSES)
    for left in (1, 0):
        unit_stresses(contact, bool(left), tmp_path)
        assert stress_seconds(pair, contact.plan, tmp_path) == pytest.approx(left * different * each)


def with_forces(found: SolvedOperatingPoint, keep: np.ndarray, factor: float = 1.0) -> SolvedOperatingPoint:
    solution = found.solution
    changed = replace(solution, force=factor * np.where(keep, solution.force, 0.0))
    return replace(found, solved=[(found.problem, changed)])


@pytest.mark.law
@pytest.mark.parametrize("model", ["plane_strain", "3d"])
def test_stress_is_linear_in_the_forces(cache, model):
    found = place(SPUR, cache, model)
    if model == "3d":
        unit = unit_root_stress_3d(GEAR, finer_root(SectorRecipe.draft(GEAR)), cache=cache)
    else:
        unit = unit_root_stress(GEAR, MeshRecipe.standard(GEAR).refined(0.6), cache=cache)
    whole = pair_histories(found, (unit, unit))[0].stress
    first = found.problem.candidates.pair < 0
    parts = [pair_histories(with_forces(found, keep), (unit, unit))[0].stress for keep in (first, ~first)]
    scale = np.abs(whole).max()
    assert min(np.abs(part).max() for part in parts) > 0.1 * scale
    assert np.abs(sum(parts) - whole).max() < 1e-12 * scale
    double = pair_histories(with_forces(found, np.ones_like(first), 2.0), (unit, unit))[0].stress
    assert np.array_equal(double, 2.0 * whole)


def test_one_pair_alone_gives_stress_in_proportion_to_the_load(cache):
    """At the pitch point nothing is shared, so that the contact cannot change where the force goes."""
    one, five = (solved(SPUR, cache, normal_force=f, at=[0.0]).pinion for f in (FORCE, 5.0 * FORCE))
    assert np.abs(five.stress - 5.0 * one.stress).max() < 1e-9 * np.abs(five.stress).max()
    own = np.abs(one.stress).max(axis=(0, 2, 3, 4, 5))
    assert own[one.pair == 0] > 2.0 * own[one.pair != 0].max()  # neighbors share the tooth spaces
    assert own.min() > 0.0


def test_gears_alike_are_mirror_images_in_position(cache):
    """What the pinion's tooth meets on its way in, the wheel's meets on its way out."""
    found = solved(SPUR, cache, at=np.arange(16) / 16, effects=NO_CORNERS)
    pinion, wheel = found.pinion.passage(), found.wheel.passage()
    inside = np.abs(pinion.position) < 1.5
    for name in ("tension", "compression"):
        mine = getattr(pinion, name)[inside]
        theirs = np.interp(-pinion.position[inside], wheel.position, getattr(wheel, name))
        assert np.abs(mine - theirs).max() < 1e-6 * np.abs(mine).max()


@pytest.mark.nightly
def test_opposite_hands_are_mirror_images_along_the_face(cache):
    swapped = GearPair(*(replace(g, helix_angle=-g.helix_angle) for g in (HELICAL.pinion, HELICAL.wheel)))
    options = {"at": [0.2, 0.7], "misalignment": 10e-6}
    one = solved(HELICAL, cache, **options)
    other = solved(swapped, cache, **(options | {"misalignment": -10e-6}))
    for mine, theirs in ((one.pinion, other.pinion), (one.wheel, other.wheel)):
        mirrored = theirs.stress[..., ::-1] * np.array([1.0, 1.0, -1.0])[:, None, None]
        assert np.abs(mirrored - mine.stress).max() < 1e-6 * np.abs(mine.stress).max()
        assert mine.peak("tension").face_position == pytest.approx(-theirs.peak("tension").face_position)


def test_misalignment_raises_the_stress_where_the_load_goes(cache):
    aligned, skew = (solved(SPUR, cache, at=[0.0], model="3d", misalignment=m) for m in (0.0, 20e-6))
    for gear in ("pinion", "wheel"):
        low, high = (getattr(found, gear).peak("tension") for found in (aligned, skew))
        assert high.stress.value > 1.3 * low.stress.value
        assert high.face_position < -5e-3  # the gap opens towards larger face positions
        assert abs(low.face_position) < 2e-3


@pytest.mark.law
def test_the_roots_of_a_ring_gear_are_pulled_at_the_same_end(cache):
    """A ring is seen from its other side: its fillets and its ends must still be those of the contact."""
    ring = RingGear(teeth=60, normal_module=4e-3, face_width=10e-3, rim_diameter=0.29, tip_diameter=0.2342)
    pair = InternalGearPair(replace(GEAR, face_width=10e-3), ring, 80e-3)
    found = solved(pair, cache, at=[0.0], model="3d", misalignment=10e-6)
    for gear in (found.pinion, found.wheel):
        tension, compression = (gear.peak(root) for root in ("tension", "compression"))
        assert (tension.pair, compression.pair) == (0, 0)
        assert tension.face_position < -2e-3
        assert compression.face_position < -2e-3
        assert 0.7 < -tension.stress.value / compression.stress.value < 1.0
    # ISO 6336-3 looks at 60 degrees on internal gears, at 30 on external ones
    assert math.degrees(found.wheel.peak("tension").tangent_angle) == pytest.approx(55.0, abs=5.0)
    assert math.degrees(found.pinion.peak("tension").tangent_angle) == pytest.approx(37.0, abs=5.0)


def test_peak_and_passage_say_the_same(cache):
    history = solved(SPUR, cache, at=np.arange(32) / 32).pinion
    passage = history.passage()
    assert np.all(np.diff(passage.position) > 0.0)
    for root, extreme in (("tension", passage.tension.max()), ("compression", passage.compression.min())):
        peak = history.peak(root)
        assert peak.stress.value == extreme
        at = np.argmin(np.abs(passage.position - peak.position - peak.pair))
        assert getattr(passage, root)[at] == extreme
        assert getattr(passage, f"at_{root}_peak")[at] == pytest.approx(extreme, rel=0.02)
        assert peak.stress.unit == "Pa"
        assert 0.0 < peak.stress.error < 0.05 * abs(extreme)
    assert passage.tension[0] == passage.tension[-1] == 0.0  # far from the mesh


def test_crests_of_parabolas_and_slopes_lean_on_what_counts():
    s = np.array([0.0, 1.0, 1.5, 3.0, 3.5])
    values = np.stack([5.0 - 2.0 * (s - at) ** 2 for at in (1.2, 2.1, 3.2)])
    value, at = crest_values(s, values)
    assert value == pytest.approx([5.0, 5.0, 5.0], rel=1e-12)
    assert at == pytest.approx([1.2, 2.1, 3.2], rel=1e-12)
    value, at = crest_values(s, np.stack([s, -s, np.full(5, 2.0)]))
    assert value == pytest.approx([3.5, 0.0, 2.0])
    assert at[:2] == pytest.approx([3.5, 0.0])
    s = np.arange(5.0)
    value, at = crest_values(
        s, np.array([[1.0, 4.0, 5.0, -np.inf, -np.inf], [-np.inf, 3.0, 4.0, 3.0, -np.inf]])
    )
    assert value == pytest.approx([5.0, 4.0])
    assert at == pytest.approx([2.0, 2.0])


@pytest.mark.law
def test_a_root_under_the_patch_counts_for_no_peak(cache):
    """Contact next to the form point: the patch, wider than the contact, lies on the fillet."""
    gear = replace(GEAR, profile_shift_coefficient=-0.05)
    deep = GearPair(gear, replace(GEAR, profile_shift_coefficient=0.05), 80e-3)
    history = solved(deep, cache, at=np.arange(8) / 8).pinion
    near = history.near_load[..., 0]
    assert near.any()
    assert not near[:, [0, -1]].any()  # teeth that carry nothing
    lowest = history.flank_coordinate[near.any(axis=(0, 1))].min()
    unchanged = history.peak("tension")
    spoiled = history.stress.copy()
    spoiled[:, :, 0, 0, :, 0] += 1e12 * near
    assert replace(history, stress=spoiled).peak("tension") == unchanged
    assert unchanged.flank_coordinate < lowest


@pytest.mark.law
@pytest.mark.parametrize("model", ["plane_strain", "3d"])
def test_unit_loads_on_slices_give_the_peaks_of_the_whole_history(cache, model):
    """What searches follow: equal in the plane; over the face forces go to the ends of coarse layers."""
    found = place(SPUR, cache, model)
    roots = RootInfluence.of(found.contact, cache)
    units = unit_stresses(found.contact, False, cache)
    stress = roots.stress(found.problem, found.solution.force)[:, :, 0]
    for gear, history in enumerate(pair_histories(found, units)):
        peaks = np.where(history.near_load, -np.inf, history.principal("tension")).max(axis=(1, 2, 3))
        assert stress[gear] == pytest.approx(peaks, rel=1e-3 if model == "plane_strain" else 0.015)


def test_changes_of_root_stress_are_those_of_differences(cache):
    found = place(SPUR, cache, "plane_strain")
    roots, force = RootInfluence.of(found.contact, cache), found.solution.force
    change = force * np.cos(np.arange(force.size)).reshape(force.shape)
    (value, by), step = roots.rows(found.problem, force, change[None]), 1e-4
    ends = (roots.rows(found.problem, force + end * change, change[None])[0] for end in (step, -step))
    above, below = ends
    assert value.size >= 2
    assert by[:, 0] == pytest.approx((above - below) / (2.0 * step), rel=1e-7)
