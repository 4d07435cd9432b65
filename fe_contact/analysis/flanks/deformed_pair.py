"""Both gears of a pair as they bend in mesh, for viewers."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from bounds.brief import brief
from fe_contact.analysis.flanks.solved_operating_point import checked_positions, solve_operating_point
from fe_contact.analysis.request.request import Checked
from fe_contact.analysis.request.request_check import as_checked
from fe_contact.analysis.request.solved_run import SolvedOperatingPoint
from fe_contact.compliance.deformation_3d import deformed_solids
from fe_contact.compliance.deformed_gear import DeformedGear
from fe_contact.compliance.deformed_section import deformed_sections
from fe_contact.contact import face_flank_forces, plane_flank_forces
from fe_contact.errors import integer
from fe_contact.geometry import ParallelAxes, tooth_profile
from fe_contact.mesh.export import write_cells
from fe_contact.options import AnalysisOptions, OperatingPoint, Run
from fe_contact.planning.discretization import FaceDiscretization
from fe_contact.types import FloatArray
from model_studies.stage_clock import StageClock

Both = tuple[DeformedGear, DeformedGear]


@brief
@dataclass(frozen=True)
class DeformedPair:
    """Both gears at one position, placed as they mesh.

    The pinion's center is the origin, the wheel's is on +y, a ring gear's on -y; the pinion drives clockwise
    seen from +z.
    """

    position: float
    """Position of the driving gear, base pitches."""
    deflection: float
    """Static transmission error, m."""
    pinion: DeformedGear
    wheel: DeformedGear
    wheel_base_radius: float
    """Base radius of the wheel, m; negative for a ring gear."""
    wheel_center: tuple[float, float, float]
    """Center of the wheel, m."""

    @property
    def wheel_lag(self) -> FloatArray:
        """Displacement (n, 3) of the wheel's nodes by the transmission error as a small rotation, m.

        Added to the elastic displacements it closes the gap that bending opens. So the loaded flanks stay
        together in pictures whose displacements are scaled by any factor.
        """
        arm = self.wheel.points - np.asarray(self.wheel_center)
        # the wheel turns counter-clockwise, a ring gear (negative radius) clockwise; a lag is against that
        angle = -self.deflection / self.wheel_base_radius
        return angle * np.column_stack([-arm[:, 1], arm[:, 0], np.zeros(len(arm))])

    def write(self, pinion: Path, wheel: Path) -> None:
        """Write both gears as VTU files: see `docs/studies.md` for the fields."""
        _write(pinion, self.pinion, self.pinion.displacement)
        _write(wheel, self.wheel, self.wheel.displacement + self.wheel_lag)


def deformed_pairs(
    pair: ParallelAxes | Checked,
    point: OperatingPoint | None = None,
    options: AnalysisOptions = AnalysisOptions(),  # noqa: B008 (frozen)
    run: Run = Run(),  # noqa: B008 (frozen)
    *,
    at: ArrayLike = 0.0,
    neighbors: int = 1,
) -> tuple[DeformedPair, ...]:
    """Solve the contact at some positions and expand it to the finite elements of both gears.

    A plane model gives the whole transverse section, three dimensions give the loaded teeth and their
    neighbors. The bending of shafts is not included. Raises `InputError`: a value that cannot be used, by
    field name; `MeshError`, `SolveError`: no acceptable mesh, or positions without a solution.

    Parameters
    ----------
    pair : GearPair, InternalGearPair or Checked
        Gear pair, or a checked request, which replaces pair, point and options.
    point : OperatingPoint, optional
    options : AnalysisOptions
        `positions`, `receipt` and `on_violation` are ignored.
    run : Run
        Workers condense the gears. The fields are not cached: in three dimensions they cost as much as the
        compliances of both gears.
    at : array_like
        Positions in base pitches.
    neighbors : int
        Unloaded teeth to show on either side of the loaded ones, in three dimensions.

    Returns
    -------
    tuple of DeformedPair
        One per position.
    """
    checked = as_checked(pair, point, options)
    integer("neighbors", neighbors, 0, 100)
    solved = solve_operating_point(checked, checked_positions(at), StageClock(run.workers.cost), run)
    gears = _deformed_gears(solved, neighbors)
    run.progress("deformation", 1.0)
    position, deflection = solved.problem.candidates.position, solved.solution.deflection[:, 0]
    pair_at_distance = solved.contact.pair
    return tuple(
        _placed_pair(pair_at_distance, float(x), float(ste), both)
        for x, ste, both in zip(position, deflection, gears, strict=True)
    )


def _deformed_gears(point: SolvedOperatingPoint, neighbors: int = 1) -> tuple[Both, ...]:
    """Expand a solution at all its positions; each gear in its own frame."""
    contact, candidates = point.contact, point.problem.candidates
    force, made = point.solution.force[:, 0], contact.plan.discretization
    gears, positions = contact.plan.bodies(contact.pair), range(candidates.position.size)
    if isinstance(made, FaceDiscretization):
        face, offset = contact.face, contact.pair.axial_offset
        assert face is not None
        solid = [face_flank_forces(candidates, force, p, face, offset) for p in positions]
        first, second = (
            deformed_solids(
                gear,
                made.recipes[i],
                [_outward(both[i]) for both in solid],
                neighbors,
                seen_from_behind=gear.sign < 0,
            )
            for i, gear in enumerate(gears)
        )
        return tuple(zip(first, second, strict=True))
    plane = contact.plane
    assert plane is not None
    flat = [plane_flank_forces(candidates, force, p, plane) for p in positions]
    first, second = (
        deformed_sections(gear, made.recipes[i], made.hypothesis, [both[i] for both in flat])
        for i, gear in enumerate(gears)
    )
    return tuple(zip(first, second, strict=True))


def _outward(by_tooth: dict[int, FloatArray]) -> dict[int, FloatArray]:
    """Return inward nodal forces by tooth as forces along the outward normal."""
    return {tooth: -forces for tooth, forces in by_tooth.items()}


def _placed_pair(pair: ParallelAxes, position: float, deflection: float, gears: Both) -> DeformedPair:
    """Turn both gears so that their flanks touch on the line of action, at mid-face of the pinion."""
    sign = pair.wheel.sign
    center = (0.0, sign * pair.center_distance, pair.axial_offset)
    angle_1, angle_2 = mesh_angles(pair, position)
    wheel = gears[1].turned_over() if pair.internal else gears[1]
    pinion, wheel = gears[0].placed(angle_1, (0.0, 0.0, 0.0)), wheel.placed(angle_2, center)
    return DeformedPair(
        position=position,
        deflection=deflection,
        pinion=pinion,
        wheel=wheel,
        wheel_base_radius=sign * pair.wheel.base_radius,
        wheel_center=center,
    )


def mesh_angles(pair: ParallelAxes, position: float) -> tuple[float, float]:
    """Return the angles in rad that turn both tooth frames into the mesh, counter-clockwise.

    Whole base pitches of the position are left out, so that tooth 0 is the tooth of pair 0.
    The base tangent leaves the pinion at pi/2 + alpha_wt from +x; from there the path of contact runs along
    (cos alpha_wt, sin alpha_wt). A ring gear's frame has been turned over before, see `DeformedGear`.
    """
    alpha = pair.working_pressure_angle
    roll_1, roll_2 = (float(roll) for roll in pair.roll_lengths(position - math.floor(position)))
    start = pair.pinion.base_radius * np.array([-math.sin(alpha), math.cos(alpha)])
    touch = start + roll_1 * np.array([math.cos(alpha), math.sin(alpha)])
    arms = (touch, touch - np.array([0.0, pair.wheel.sign * pair.center_distance]))
    angles = []
    for gear, roll, arm in zip((pair.pinion, pair.wheel), (roll_1, roll_2), arms, strict=True):
        point = tooth_profile(gear).involute(np.array([roll]))[0]
        angles.append(math.atan2(arm[1], arm[0]) - math.atan2(point[1], gear.sign * point[0]))
    # the wheel's mid-face section is turned by its helix over the distance from the pinion's mid-face
    offset = pair.axial_offset * math.tan(pair.wheel.helix_angle) / pair.wheel.reference_radius
    return angles[0], angles[1] + offset


def _write(path: Path, gear: DeformedGear, in_mesh: FloatArray) -> None:
    stress, principal = gear.stress, gear.principal_stress
    write_cells(
        path,
        gear.points,
        gear.cells,
        {
            "displacement": gear.displacement,
            "displacement_in_mesh": in_mesh,
            "von_mises_stress": gear.von_mises,
            "largest_principal_stress": principal[:, 2],
            "least_principal_stress": principal[:, 0],
            "stress": stress[:, [0, 1, 2, 0, 1, 0], [0, 1, 2, 1, 2, 2]],  # xx, yy, zz, xy, yz, xz
        },
        {"tooth": gear.tooth, **gear.quality},
    )
