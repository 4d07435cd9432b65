"""Both gears as they bend in mesh: work, placement, files."""

import dataclasses
import math
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest
from analysis_requests import point_request, table_request

from fe_contact import Gear, GearPair, InternalGearPair, OperatingPoint, RingGear, Run, deformed_pairs
from fe_contact.analysis.flanks.deformed_pair import mesh_angles
from fe_contact.analysis.flanks.solved_operating_point import solve_operating_point
from fe_contact.analysis.request.request_check import check_request
from fe_contact.analysis.request.solved_run import SolvedOperatingPoint
from fe_contact.contact import (
    Candidates,
    contact_problem,
    face_contact_problem,
    face_flank_forces,
    plane_flank_forces,
)
from fe_contact.errors import InputError
from fe_contact.geometry import Toothing, tooth_profile
from model_studies.stage_clock import StageClock

pytestmark = pytest.mark.usefixtures("coarse_sectors")


@pytest.fixture(scope="module")
def cache(tmp_path_factory):
    return tmp_path_factory.mktemp("compliance")


def spur_pair() -> GearPair:
    gear = Gear(teeth=20, normal_module=4e-3, face_width=25e-3, bore_diameter=40e-3)
    return GearPair(gear, dataclasses.replace(gear, teeth=27), 94e-3)


def helical_pair(hand: float = 1.0, **fields: Any) -> GearPair:
    pinion = Gear(19, 3e-3, 16e-3, 30e-3, helix_angle=hand * math.radians(20.0))
    return GearPair(pinion, dataclasses.replace(pinion, teeth=26, helix_angle=-pinion.helix_angle), **fields)


def internal_pair(hand: float = 0.0, **fields: Any) -> InternalGearPair:
    """Pinion and ring gear of 18 and 48 teeth, module 2 mm."""
    helix = hand * math.radians(15.0)
    pinion = Gear(teeth=18, normal_module=2e-3, face_width=12e-3, bore_diameter=15e-3, helix_angle=helix)
    ring = RingGear(
        48,
        2e-3,
        12e-3,
        118e-3 if hand else 114e-3,
        helix_angle=helix,
        cutter_teeth=25,
        addendum_coefficient=0.7,
    )
    return InternalGearPair(pinion, ring, **fields)


def solved(pair: GearPair | InternalGearPair, cache: Path, **request: Any) -> SolvedOperatingPoint:
    checked = check_request(pair, *table_request(normal_forces=[2000.0], level="draft", **request))
    return solve_operating_point(checked, np.array([0.171875, 0.796875]), StageClock(), Run(cache=cache))


@pytest.mark.law
def test_the_work_of_the_forces_is_that_of_the_contact(cache):
    """f' S f of both gears, tooth by tooth, is F' C F of the contact; corner forces count by their lever.

    In the plane, edges also yield along their flanks: work that forces across the flank do not do.
    """
    cases = (
        (spur_pair(), {"model": "plane_strain"}),
        (helical_pair(axial_offset=2e-3), {"misalignments": [15e-6]}),
        (internal_pair(1.0), {"misalignments": [15e-6]}),
    )
    for pair, request in cases:
        place = solved(pair, cache, **request)
        contact, candidates, force = place.contact, place.problem.candidates, place.solution.force[:, 0]
        compliance = bare_compliance(place)
        pressed = candidates.on_slices(force)
        levers = np.stack([candidates.touch.lever_1, candidates.touch.lever_2])
        assert np.all(np.any((levers != 1.0) & (force > 0.0), axis=(1, 2)))  # both tips touch somewhere
        for p in range(2):
            if contact.face is not None:
                both = face_flank_forces(candidates, force, p, contact.face, pair.axial_offset)
                flanks, width = contact.face, 1.0
            else:
                assert contact.plane is not None
                both = plane_flank_forces(candidates, force, p, contact.plane)
                flanks, width = contact.plane, candidates.slices.width
            work = width * sum(
                float(f @ flank.block(tooth, other) @ g)
                for flank, forces in zip(flanks, both, strict=True)
                for tooth, f in forces.items()
                for other, g in forces.items()
            )
            by_contact = pressed[p] @ compliance[p] @ pressed[p]
            if contact.plane is not None:
                by_contact -= along_flanks(candidates, force, p, contact.plane)
            assert work == pytest.approx(by_contact, rel=1e-10)
            turned = [abs(sum(float(f.sum()) for f in forces.values())) * width for forces in both]
            assert turned == pytest.approx([2000.0, 2000.0], rel=0.05)


def along_flanks(candidates: Candidates, force: np.ndarray, p: int, flanks: tuple[Any, Any]) -> float:
    """Work of forces at tip edges by what the edges move along their flanks, other than in a turn, N m.

    Such a force yields 1 + kappa (l - 1) times as far as one across the flank, not its lever l times.
    """
    slices, work = candidates.slices, 0.0
    levers = candidates.touch.lever_1[p], candidates.touch.lever_2[p]
    for g, (flank, lever) in enumerate(zip(flanks, levers, strict=True)):
        for i in np.flatnonzero((lever != 1.0) & (force[p] > 0.0)):
            alone = np.zeros_like(force)
            alone[p, i] = force[p, i]
            ((tooth, f),) = plane_flank_forces(candidates, alone, p, flanks)[g].items()
            across = float(f @ flank.block(tooth, tooth) @ f) / lever[i] ** 2
            kappa = float(f @ flank.along @ f) / slices.tip_inclinations[g] / lever[i] ** 2 / across
            work += slices.width * across * ((1.0 + kappa * (lever[i] - 1.0)) ** 2 - lever[i] ** 2)
    return work


def bare_compliance(place: SolvedOperatingPoint) -> np.ndarray:
    """Compliance between the candidates without shafts and other additions."""
    contact, candidates = place.contact, place.problem.candidates
    if contact.face is not None:
        return face_contact_problem(candidates, contact.face, contact.pair.axial_offset).compliance
    assert contact.plane is not None
    return contact_problem(candidates, contact.plane).compliance


@pytest.mark.parametrize(
    "pair",
    [
        spur_pair(),
        helical_pair(),
        helical_pair(-1.0),
        helical_pair(axial_offset=3e-3),
        internal_pair(),
        internal_pair(1.0, axial_offset=1e-3),
    ],
    ids=["spur", "right", "left", "offset", "internal spur", "internal helical"],
)
def test_placed_flanks_touch_on_every_contact_line(pair):
    """Points of both profiles at the roll lengths of all pairs, at several planes, are the same points."""
    for position in (0.0, 0.3, 0.9):
        angles = mesh_angles(pair, position)
        for face in (-5e-3, 0.0, 6e-3):
            for index in (-1, 0, 1):
                roll_1, _ = pair.roll_lengths(position, index)
                roll = float(roll_1) - face * math.tan(pair.base_helix_angle)
                mating = float(pair.mating_roll_length(roll))
                where = [
                    flank_point(gear, tooth, angle, own, along)
                    for gear, tooth, angle, own, along in (
                        (pair.pinion, -index, angles[0], roll, face),
                        (
                            pair.wheel,
                            index,
                            angles[1],
                            mating,
                            face - pair.axial_offset,
                        ),
                    )
                ]
                where[1] += np.array([0.0, pair.wheel.sign * pair.center_distance])
                assert where[0] == pytest.approx(where[1], abs=1e-12)


def test_a_base_pitch_later_the_next_teeth_stand_there():
    assert mesh_angles(spur_pair(), 3.25) == pytest.approx(mesh_angles(spur_pair(), 0.25), abs=1e-12)
    with pytest.raises(InputError, match="neighbors = -1"):
        deformed_pairs(spur_pair(), OperatingPoint(torque=10.0), neighbors=-1)
    with pytest.raises(InputError, match=r"at = \[\]"):
        deformed_pairs(spur_pair(), OperatingPoint(torque=10.0), at=[])


def flank_point(gear: Toothing, tooth: int, angle: float, roll: float, along: float) -> np.ndarray:
    """Point of a tooth's right flank in the plane of mesh; a ring is seen from behind."""
    turn = angle + gear.sign * 2.0 * math.pi * tooth / gear.teeth
    turn += math.tan(gear.helix_angle) / gear.reference_radius * along
    c, s = math.cos(turn), math.sin(turn)
    own = tooth_profile(gear).involute(np.array([roll]))[0] * [gear.sign, 1.0]
    return np.array([[c, -s], [s, c]]) @ own


@pytest.fixture(scope="module")
def found(cache):
    return deformed_pairs(
        helical_pair(),
        *point_request(normal_force=2000.0, misalignment=15e-6, level="draft"),
        Run(cache=cache),
        at=[0.0, 0.45],
    )


def test_files_come_back_as_they_were(found, tmp_path):
    one = found[1]
    files = tmp_path / "pinion.vtu", tmp_path / "wheel.vtu"
    one.write(*files)
    assert sorted(tmp_path.iterdir()) == sorted(files)
    for file, gear in zip(files, (one.pinion, one.wheel), strict=True):
        back = meshio.read(file)
        assert np.array_equal(back.points, gear.points)
        assert np.array_equal(back.cells_dict["hexahedron20"], gear.cells)
        assert np.array_equal(back.point_data["displacement"], gear.displacement)
        assert np.array_equal(back.point_data["von_mises_stress"], gear.von_mises)
        assert np.array_equal(back.point_data["stress"][:, 3], gear.stress[:, 0, 1])
        assert np.array_equal(back.point_data["stress"][:, 4], gear.stress[:, 1, 2])
        assert np.array_equal(back.cell_data["tooth"][0], gear.tooth)
        assert back.cell_data["scaled_jacobian"][0].min() > 0.0
    lag = meshio.read(files[1]).point_data["displacement_in_mesh"] - one.wheel.displacement
    assert lag == pytest.approx(one.wheel_lag, abs=1e-18)


def test_the_wheel_lags_by_the_transmission_error_and_flanks_give_way(found):
    pair, one = helical_pair(), found[0]
    alpha = pair.working_pressure_angle
    along = np.array([math.cos(alpha), math.sin(alpha), 0.0])
    arm = one.wheel.points - np.array(one.wheel_center)
    distance = arm @ np.array([math.sin(alpha), -math.cos(alpha), 0.0])  # from the wheel's axis
    expected = -one.deflection * distance / pair.wheel.base_radius
    assert one.wheel_lag @ along == pytest.approx(expected, abs=1e-15)
    assert one.deflection > 1e-6
    # Elastic displacement opens the mesh: the pinion's teeth give way against the line of action.
    alpha = helical_pair().working_pressure_angle
    along = np.array([math.cos(alpha), math.sin(alpha), 0.0])
    for one in found:
        for gear, sense in ((one.pinion, -1.0), (one.wheel, 1.0)):
            largest = np.linalg.norm(gear.displacement, axis=1).argmax()
            assert sense * (gear.displacement[largest] @ along) > 0.0


@pytest.mark.parametrize("hand", [1.0, -1.0])
def test_meshes_of_pinion_and_ring_meet_where_the_load_is(hand, cache):
    """Under a load at one end of the face both are stressed most there, and there the other mesh is near."""
    pair = internal_pair(hand)
    (found,) = deformed_pairs(
        pair,
        *point_request(normal_force=500.0, misalignment=100e-6, level="draft"),
        Run(cache=cache),
        at=0.2,
        neighbors=0,
    )
    for gear, other in ((found.pinion, found.wheel), (found.wheel, found.pinion)):
        maximum = gear.points[gear.von_mises.argmax()]
        assert maximum[2] == pytest.approx(-0.5 * pair.face_width, rel=1e-6)
        near = 0.4 * pair.pinion.normal_module  # two elements of the draft flank
        stressed = gear.points[
            gear.von_mises > 0.9 * gear.von_mises.max()
        ]  # nodes that rounding may exchange
        apart = np.linalg.norm(other.points - stressed[:, None], axis=2)
        assert apart.min() < near
        assert gear.residual < 1e-10
