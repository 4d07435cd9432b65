"""The list of force laws: the arrays that hold those of a kind, and the compiled functions of them.

An element has p local coordinates y = G q + y0 in meters and gives p local forces f(y, y', x) in newtons,
which act on the freedoms as -G^T f. To add a law: its file (what a scene holds, packed arrays, compiled
functions), and here its number, its arrays and its row of `COMPILED`. A bearing law that is a part of the
scene derives from `SceneBearingLaw`; here it also has its field of `BearingLawParts` and its row of
`LAW_BY_ARRAYS`, and its table of a scene file is in `lineofaction/gearbox/schemas/bearings.py`.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from functools import cache
from typing import Any, NamedTuple, get_args, get_type_hints

import numpy as np

from dynamics.bearings.ball_elements import BallElements, axial_seat, balls, balls_energy
from dynamics.bearings.linear_bearing import LinearBearingLaws, linear_bearing, linear_bearing_energy
from dynamics.bearings.roller_elements import RollerElements, rollers, rollers_energy
from dynamics.bearings.rolling_contact import (
    RollingContact,
    RollingContactLaws,
    rolling_contact,
    rolling_contact_energy,
)
from dynamics.bearings.spring_curve import SpringCurve, SpringCurveLaws, spring_curve, spring_curve_energy
from dynamics.forces.frame_coupling import FrameCouplingLaws, frame_coupling, frame_coupling_energy
from dynamics.forces.frames import RotatingFrameLaws, rotating_frame, rotating_frame_energy
from dynamics.kernels.routine import Routine
from dynamics.loads.load_laws import ForceCourseLaws, applied_force
from dynamics.loads.speed_torque_law import SpeedTorqueLaws, speed_torque
from dynamics.loads.unbalance_law import UnbalanceLaws, unbalance, unbalance_energy
from dynamics.meshes.flank_force import FlankLaws, flank, flank_energy
from dynamics.meshes.spatial_flank import SpatialFlankLaws, spatial_energy, spatial_flank
from dynamics.types import BoolArray, IntArray


class Law(IntEnum):
    """Kinds of force laws by number, as compiled functions tell them apart."""

    FLANK = 0  # p = 1: a flank in contact, from its table
    SPEED_TORQUE = 1  # p = 1: a torque that depends on a shaft's speed
    ROLLING_CONTACT = 2  # p = 2: a rolling bearing's radial force
    SPRING_CURVE = 3  # p = 1: a bearing's force by displacement in one direction
    SPATIAL_FLANK = 4  # p = 1 to 5: a flank that feels misalignment, center distance, friction
    ROTATING_FRAME = 5  # p = 2 or 3: gyroscopic moments, Coriolis and centripetal terms
    FRAME_COUPLING = 6  # p = 4 or 8: a coupling of shafts in frames that turn against each other
    BALLS = 7  # p = 5: a bearing's row of balls
    ROLLERS = 8  # p = 5: a bearing's row of rollers
    APPLIED_FORCE = 9  # p = 1 to 4: a force on a shaft by time, speed or angle
    UNBALANCE = 10  # p = 3: mass off a shaft's axis
    LINEAR_BEARING = 11  # p = 1 to 5: a linear bearing in a housing that moves


class ElementLaws(NamedTuple):
    """The packed laws of all kinds, one field per kind: its name in small letters."""

    flank: FlankLaws
    speed_torque: SpeedTorqueLaws
    rolling_contact: RollingContactLaws
    spring_curve: SpringCurveLaws
    spatial_flank: SpatialFlankLaws
    rotating_frame: RotatingFrameLaws
    frame_coupling: FrameCouplingLaws
    balls: BallElements
    rollers: RollerElements
    applied_force: ForceCourseLaws
    unbalance: UnbalanceLaws
    linear_bearing: LinearBearingLaws


class Compiled(NamedTuple):
    """The compiled functions of a kind of law.

    The names of their parameters say what they read: `laws` the arrays of the kind, `entry` the index in
    them, `local` the state, `row` the first row, `e` the element, `mesh` the mesh whose position it reads,
    `turned` the frame or cage whose position it reads.
    """

    force: Any
    """Writes forces and derivatives."""
    energy: Any = None
    """Returns the energy stored, J, then derivatives, if any; the first one is by the position, J per base
    pitch or revolution. None: no energy.
    """
    inside: tuple[Routine, ...] = ()
    """Compiled routines that `force` and `energy` both call."""

    @property
    def routines(self) -> tuple[Routine, ...]:
        """Routines that are compiled when a scene first has the law; flanks are part of every loop."""
        return tuple(call for call in (*self.inside, self.force, self.energy) if isinstance(call, Routine))


COMPILED = {
    Law.FLANK: Compiled(flank, flank_energy),
    Law.SPEED_TORQUE: Compiled(speed_torque),
    Law.ROLLING_CONTACT: Compiled(rolling_contact, rolling_contact_energy),
    Law.SPRING_CURVE: Compiled(spring_curve, spring_curve_energy),
    Law.SPATIAL_FLANK: Compiled(spatial_flank, spatial_energy),
    Law.ROTATING_FRAME: Compiled(rotating_frame, rotating_frame_energy),
    Law.FRAME_COUPLING: Compiled(frame_coupling, frame_coupling_energy),
    Law.BALLS: Compiled(balls, balls_energy, (axial_seat,)),
    Law.ROLLERS: Compiled(rollers, rollers_energy),
    Law.APPLIED_FORCE: Compiled(applied_force),
    Law.UNBALANCE: Compiled(unbalance, unbalance_energy),
    Law.LINEAR_BEARING: Compiled(linear_bearing, linear_bearing_energy),
}


@dataclass(frozen=True, kw_only=True)
class BearingLawParts:
    """The nonlinear laws of bearings that are parts of a scene, by kind.

    Each names its bushing or planet bearing. A bearing in a housing without mass cannot have one.
    """

    rolling_contacts: tuple[RollingContact, ...] = ()
    spring_curves: tuple[SpringCurve, ...] = ()


BEARING_PARTS: dict[str, type[Any]] = {
    kind: get_args(parts)[0] for kind, parts in get_type_hints(BearingLawParts).items()
}
"""The kinds of `BearingLawParts`, by name."""
LAW_BY_ARRAYS: dict[Any, Law] = {
    RollingContactLaws: Law.ROLLING_CONTACT,
    SpringCurveLaws: Law.SPRING_CURVE,
    BallElements: Law.BALLS,
    RollerElements: Law.ROLLERS,
}
"""Kinds of a `BearingLaw`, by their arrays."""
BEARING_LAW_KINDS = (*LAW_BY_ARRAYS.values(), Law.LINEAR_BEARING)
"""Laws of bearings; each is the gradient of a convex energy, so that the static equilibrium is unique."""


def among(law: IntArray, laws: tuple[Law, ...]) -> BoolArray:
    """Return which elements, by their `law` (E,), have one of `laws`."""
    return np.asarray(_marked(laws)[law])


@cache
def _marked(laws: tuple[Law, ...]) -> BoolArray:
    return np.array([law in laws for law in Law])
