"""The scene: everything a run needs, frozen, in SI units."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, is_dataclass, replace
from itertools import chain
from typing import Any, get_args, get_origin, get_type_hints

from bounds import at_most
from dynamics.bearings import Bushing, PlanetBearing, RollingBearing
from dynamics.bearings.bearing_law import BearingLaw
from dynamics.bearings.row_law import row_law
from dynamics.checks import not_negative, one_of, positive, within
from dynamics.errors import InputError
from dynamics.forces import SpeedTorque
from dynamics.forces.laws import BEARING_PARTS, BearingLawParts
from dynamics.joints import Coupling, FreeRotation, Housing, ImposedRotation
from dynamics.loads import AppliedForce, LoadTorque, Unbalance
from dynamics.meshes import GearMesh
from dynamics.scene.scene_checks import check_parts
from dynamics.settings import Integration, Outputs
from dynamics.settings.level_quantity import LevelQuantity
from dynamics.shafts import DiscBody, GearBody, Shaft
from dynamics.temperatures import Temperatures

ON_VIOLATION = ("repeat", "fail", "report")
TOLERANCES = (1e-6, 0.5)  # least and largest relative tolerance of a scene
LEVEL_TOLERANCES = (1e-9, 3.0)  # dB
SAMPLE_LIMIT = 2e7  # a run's states are held in memory
MIN_RATE = 1000.0  # Hz, of an output whose rate is chosen


@dataclass(frozen=True)
class Scene(BearingLawParts):
    """A geared system and its run."""

    shafts: tuple[Shaft, ...]
    gears: tuple[GearBody, ...]
    meshes: tuple[GearMesh, ...]
    drives: tuple[ImposedRotation, ...]
    duration: float
    """Duration of the run, s."""
    bushings: tuple[Bushing, ...] = ()
    loads: tuple[LoadTorque, ...] = ()
    planet_bearings: tuple[PlanetBearing, ...] = ()
    free_rotations: tuple[FreeRotation, ...] = ()
    couplings: tuple[Coupling, ...] = ()
    speed_torques: tuple[SpeedTorque, ...] = ()
    housings: tuple[Housing, ...] = ()
    discs: tuple[DiscBody, ...] = ()
    rolling_bearings: tuple[RollingBearing, ...] = ()
    forces: tuple[AppliedForce, ...] = ()
    unbalances: tuple[Unbalance, ...] = ()
    """`speed_torques`, `housings`, `discs`, `rolling_bearings`, `forces`, `unbalances`: Parts, each with a
    name unique among its kind. Drives and free rotations together set the kinematic motion of all shafts: one
    for each independent speed of the gearing.
    """
    gravity: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Acceleration of gravity in the fixed frame, m/s^2. A component across the axis needs a scene without
    rotating frames.
    """
    effects: Mapping[str, str] = field(default_factory=dict)
    """Effect name to ``"auto"``, ``"on"`` or ``"off"``; effects that are not named are ``"auto"``."""
    outputs: Outputs = field(default_factory=Outputs)
    integration: Integration = field(default_factory=Integration)
    on_violation: str = "repeat"
    """Reaction to a violated assumption of a run or a study. ``"repeat"`` runs again with the automatic
    effect that is needed, and raises if the result is invalid and no effect corrects it; ``"fail"`` raises at
    any violation, ``"report"`` reports it in the ledger's checks.
    """
    tolerance: float | None = None
    """Relative change of mean and peak-to-peak transmission error and of bearing forces that neglected
    automatic effects may cause in a run; None: effects are as the scene calls for them.
    """
    highest_frequency: float | None = None
    """Frequency to which flexible shafts are resolved, Hz; None: half the rate that all wanted orders need,
    up to 2.56 times the band of the output.
    """
    temperatures: Temperatures | None = None
    """Temperatures of the housing and, as far as stated, of shafts, gears and rings of rolling bearings.
    None: all parts as drawn.
    """
    quantity: LevelQuantity | None = None
    """Quantity for which the scene is computed. The change of its level sizes effects, and with a tolerance
    decides on them. None: bearing forces; transmission errors then decide too.
    """
    level_tolerance: float | None = None
    """Change of levels, dB, that neglected automatic effects may cause in a run, where `tolerance` is None.
    It is the level of `quantity`, by default of bearing forces and transmission errors.
    """

    def __post_init__(self) -> None:
        not_negative("duration", self.duration)
        one_of("on_violation", self.on_violation, ON_VIOLATION)
        if self.tolerance is not None:
            within("tolerance", self.tolerance, *TOLERANCES)
        if self.level_tolerance is not None:
            within("level_tolerance", self.level_tolerance, *LEVEL_TOLERANCES)
        if self.highest_frequency is not None:
            positive("highest_frequency", self.highest_frequency)
        check_samples(self.duration, self.outputs.sample_rate or MIN_RATE)
        check_parts(self)

    @property
    def parts(self) -> dict[str, tuple[Any, ...]]:
        """All parts, by the names of the fields that hold them."""
        return {kind: getattr(self, kind) for kind in KINDS}

    @property
    def references(self) -> tuple[ImposedRotation | FreeRotation, ...]:
        """The laws of the kinematic motion: the drives, then the free rotations."""
        return (*self.drives, *self.free_rotations)

    @property
    def ground_bearings(self) -> tuple[Bushing, ...]:
        """All bearings between shafts and the ground: bushings, and the places of rolling bearings."""
        return (*self.bushings, *(bearing.support for bearing in self.rolling_bearings))

    @property
    def bearing_laws(self) -> tuple[BearingLaw, ...]:
        """Nonlinear laws of all bearings, rolling elements averaged."""
        return self.laws_with(frozenset())

    def laws_with(self, passing: frozenset[str]) -> tuple[BearingLaw, ...]:
        """Return the nonlinear laws of all bearings; the elements of those in `passing` pass one by one."""
        rows = (row_law(bearing, bearing.name in passing) for bearing in self.rolling_bearings)
        return (*self.scene_bearing_laws, *rows)

    @property
    def scene_bearing_laws(self) -> tuple[Any, ...]:
        """The nonlinear laws of bearings that are parts of the scene, each a `SceneBearingLaw`."""
        return tuple(chain.from_iterable(getattr(self, kind) for kind in BEARING_PARTS))

    def with_bearing_laws(self, change: Callable[[Any], BearingLaw]) -> Scene:
        """Return the scene with `change` of each of its `scene_bearing_laws` in its place."""
        laws: dict[str, Any] = {
            kind: tuple(change(law) for law in getattr(self, kind)) for kind in BEARING_PARTS
        }
        return replace(self, **laws)

    def require_meshes(self) -> None:
        """Refuse a scene without meshes to a study that compares transmission errors."""
        if not self.meshes:
            raise InputError("meshes", 0, "at least one: transmission errors are compared")

    def gear(self, name: str) -> GearBody:
        """Return the gear called `name`."""
        return next(gear for gear in self.gears if gear.name == name)

    def shaft(self, name: str) -> Shaft:
        """Return the shaft called `name`."""
        return next(shaft for shaft in self.shafts if shaft.name == name)

    def crosses_frames(self, coupling: Coupling) -> bool:
        """Whether a coupling has matrices and joins shafts of different frames."""
        different_frames = self.shaft(coupling.first).frame != self.shaft(coupling.second).frame
        return different_frames and (coupling.stiffness is not None or coupling.damping is not None)

    def mounted(self, shaft: str) -> tuple[GearBody | DiscBody, ...]:
        """Return the rigid bodies on the shaft called `shaft`: gears, then discs."""
        bodies: tuple[GearBody | DiscBody, ...] = (*self.gears, *self.discs)
        return tuple(body for body in bodies if body.shaft == shaft)

    def frame_index(self, shaft: int) -> int | None:
        """Return the index of the carrier in whose frame the shaft `shaft` is described, or None."""
        name = self.shafts[shaft].frame
        return None if name is None else self.shaft_index(name)

    def shaft_index(self, name: str) -> int:
        """Return the index of the shaft called `name`."""
        return [shaft.name for shaft in self.shafts].index(name)


KINDS = tuple(
    kind
    for kind, hint in get_type_hints(Scene).items()
    if get_origin(hint) is tuple and is_dataclass(get_args(hint)[0])
)
"""Kinds of parts: the fields of `Scene` that hold them."""


def check_samples(duration: float, rate: float) -> None:
    """Refuse a run of too many samples; raises `InputError` naming its duration."""
    if duration * rate > SAMPLE_LIMIT:
        bound = at_most(SAMPLE_LIMIT / rate, "s", note=f", {SAMPLE_LIMIT:g} samples at {rate:g} Hz")
        suggestion = "Shorten the run, or lower outputs.mesh_orders or outputs.sample_rate."
        raise InputError("duration", duration, bound, suggestion)
