"""A scene under a load case: constant speeds and loads, with all effects of statics.

The *leading* shaft is that of the first drive that turns, to whose speed and torque a load case refers. A
*law* is the given motion of a train.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace

from bounds import above
from dynamics.effects import EFFECTS
from dynamics.errors import InputError
from dynamics.joints import ImposedRotation
from dynamics.loads import AppliedForce, BySpeed, TimeLaw
from dynamics.loads.load_course import mean_factor
from dynamics.mechanism.kinematics import Kinematics, at_steady_speeds, solve_kinematics
from dynamics.mechanism.resting_housings import resting_housings
from dynamics.scene.scene import Scene
from dynamics.settings.load_case import DRIVE, CaseForce, LoadCase, Vector
from dynamics.types import FloatArray
from model_studies import in_unit

STATIC = 1.0
"""Highest frequency, Hz, for which shafts are resolved. Static deflections under forces at parts on a shaft
are exact in any resolution.
"""


@dataclass(frozen=True)
class ForceUnderCase:
    """A force of a scene under a load case, without the factor of its course (over time, angle or speed)."""

    name: str
    shaft: str
    """Shaft on which the force acts."""
    force: FloatArray = field(metadata=in_unit("n", "axis"))
    """Along x, y, z, N. Shape (3,)."""
    moment: FloatArray = field(metadata=in_unit("n_m", "axis"))
    """About x, y, z, N m. Shape (3,)."""


def _case_force(force: AppliedForce, specified: CaseForce | None) -> AppliedForce:
    """Return a force with the values that a load case states."""
    if specified is None:
        return force
    factor = 1.0 if specified.factor is None else specified.factor
    return replace(
        force,
        force=_times(factor, force.force if specified.force is None else specified.force),
        moment=_times(factor, force.moment if specified.moment is None else specified.moment),
    )


def _times(factor: float, vector: Vector) -> Vector:
    x, y, z = vector
    return factor * x, factor * y, factor * z


@dataclass(frozen=True)
class _Leader:
    """The leading shaft of a scene."""

    law: int
    """Index of its law in the kinematic motion."""
    shaft: str
    speed: float
    """Speed of largest magnitude in the scene, rad/s about +z; 0: a free rotation that starts from rest."""
    forward: int
    """Sign of its rotation about +z."""


def leader_of(scene: Scene) -> _Leader:
    """Return the leading shaft of `scene`."""
    for law, drive in enumerate(scene.drives):
        if drive.speed.extreme != 0.0:
            speed = float(drive.speed.extreme)
            return _Leader(law, drive.shaft, speed, 1 if speed > 0.0 else -1)
    first = scene.free_rotations[0]
    return _Leader(len(scene.drives), first.shaft, first.initial_speed, first.forward)


def loaded_scene(scene: Scene, case: LoadCase) -> Scene:
    """Return `scene` under the constant loads and speeds of `case`, with all effects of statics.

    Raises `InputError`: the case has no speed, or no factor on the scene's loads gives its torque.
    """
    leader = leader_of(scene)
    speed = _speed(leader, case)
    # factor on the speeds of the scene; `_fixed_trains` gives a leader at rest the speed 1
    scale = _turned(case) * (speed / abs(leader.speed) if leader.speed else speed)
    drives = (*at_steady_speeds(scene, scale).drives, *_fixed_trains(scene, leader, scale))
    driven = replace(scene, drives=drives, free_rotations=())
    return replace(
        with_loads(driven, case),
        housings=resting_housings(scene),
        effects=_effects_at_rest(scene),
        tolerance=None,
        highest_frequency=STATIC,
    )


def with_loads(scene: Scene, case: LoadCase) -> Scene:
    """Return `scene` with the constant loads and the forces of `case`.

    Every drive keeps its largest speed: a load case has no torque of acceleration. Raises the `InputError` of
    `loaded_scene`.
    """
    case_forces = {part.name: part for part in case.forces}
    steady = at_steady_speeds(scene)
    pushed = replace(
        steady, forces=tuple(_case_force(force, case_forces.get(force.name)) for force in scene.forces)
    )
    factor = case.factor
    if case.torque is not None:
        factor = _factor(pushed, _speed(leader_of(scene), case), case.torque)
    return replace(
        pushed,
        loads=tuple(
            replace(load, torque=TimeLaw.constant(factor * float(load.torque(0.0)))) for load in scene.loads
        ),
        meshes=tuple(
            replace(
                mesh,
                technique="variable_torque",  # the force follows from table and deflection
                nominal_force=None,
                # the coast flanks face the other way: their misalignment has the other sign
                misalignment=_turned(case) * mesh.misalignment,
            )
            for mesh in scene.meshes
        ),
    )


def _turned(case: LoadCase) -> float:
    """Return the sign of a load case: -1 if the coast flanks carry, so that the scene turns backwards."""
    return 1.0 if case.direction == DRIVE else -1.0


def _speed(leader: _Leader, case: LoadCase) -> float:
    """Return the speed of the leading shaft, rad/s; raises `InputError`: neither case nor scene has one."""
    speed = abs(leader.speed) if case.speed is None else case.speed
    if speed == 0.0:
        raise InputError("speed", 0.0, above(0.0, "rad/s"), "The scene starts from rest: give the speed.")
    return speed


def _effects_at_rest(scene: Scene) -> dict[str, str]:
    """Return the choices of effects: those that act at rest are on unless the scene switches them off."""
    acts = {effect.name: effect.in_statics for effect in EFFECTS}
    known = {name: "on" if on else "off" for name, on in acts.items() if on is not None}  # None: as in a run
    chosen = scene.effects.items()
    return known | {name: choice for name, choice in chosen if choice == "off" or name not in known}


def _fixed_trains(scene: Scene, leader: _Leader, scale: float) -> Iterator[ImposedRotation]:
    """Yield a drive for every free train, which carries the torque that its loads do not balance."""
    for free in scene.free_rotations:
        speed = free.initial_speed or (free.forward if free.shaft == leader.shaft else 0.0)
        if speed == 0.0:
            bound = above(0.0, "rad/s")
            raise InputError("initial_speed", 0.0, bound, f'Give "{free.name}" its speed in the scene.')
        yield ImposedRotation(free.name, free.shaft, TimeLaw.constant(scale * speed))


def leading_torque(scene: Scene, leader: _Leader, speed: float) -> tuple[float, float]:
    """Return the torque on the leading shaft at a speed, N m: by loads at t = 0, and by all other torques.

    By virtual power a load T on a shaft at r times the leader's speed is the torque r T on the leader. The
    other torques are those that depend on speed, and the moments of forces about the axis, which count about
    +z.
    """
    kinematics = solve_kinematics(scene)
    loads = sum(
        float(load.torque(0.0)) * _toward(kinematics, scene.shaft_index(load.shaft), leader)
        for load in scene.loads
    )
    by_speed = 0.0
    for part in scene.speed_torques:
        toward = _toward(kinematics, scene.shaft_index(part.shaft), leader)
        by_speed += float(part.curve(abs(toward) * speed)) * toward
    of_moments = 0.0
    for force in scene.forces:
        if force.moment[2] != 0.0:
            shaft = scene.shaft_index(force.shaft)
            read = force.course.shaft if isinstance(force.course, BySpeed) else force.shaft
            at = abs(_toward(kinematics, scene.shaft_index(read), leader)) * speed
            resists = -kinematics.sense[shaft] * force.moment[2] * float(mean_factor(force.course, 0.0, at))
            of_moments += resists * _toward(kinematics, shaft, leader)
    return loads, by_speed + of_moments


def _toward(kinematics: Kinematics, shaft: int, leader: _Leader) -> float:
    """Return the speed of a shaft over the leader's; > 0 if a torque against the shaft resists the leader."""
    return kinematics.sense[shaft] * leader.forward * float(kinematics.ratio[shaft][leader.law])


def _factor(scene: Scene, speed: float, torque: float) -> float:
    """Return the factor on the loads with which the leading shaft carries `torque`, N m."""
    loads, further = leading_torque(scene, leader_of(scene), speed)
    from_loads = torque - further
    if loads == 0.0 or from_loads / loads <= 0.0:
        bound = above(further, "N m", "the torque that speed and forces exert,") if loads else "left out"
        raise InputError("torque", torque, bound, "The scene's loads at t = 0 must resist the leading shaft.")
    return from_loads / loads
