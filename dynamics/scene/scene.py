"""The scene: everything a run needs, frozen, in SI units."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Protocol

from bounds import Text, at_most, between
from dynamics.bearings import Bushing, PlanetBearing, RollingBearing
from dynamics.bearings.bearing_law import BearingLaw
from dynamics.bearings.row_law import row_law
from dynamics.checks import distinct, not_negative, one_of, positive, within
from dynamics.errors import InputError, SolveError
from dynamics.forces import RollingContact, SpeedTorque, SpringCurve
from dynamics.joints import Coupling, FreeRotation, Housing, ImposedRotation
from dynamics.loads import AngleLaw, AppliedForce, LoadTorque, TimeLaw, Unbalance
from dynamics.meshes import GearMesh
from dynamics.parts import KINDS, ON_A_SHAFT
from dynamics.scene.force_check import check_force_shafts
from dynamics.scene.frame_check import check_couplings, check_frames, check_gravity, check_on_axis
from dynamics.scene.housing_check import check_housings
from dynamics.settings import Integration, Outputs
from dynamics.shafts import DiscBody, GearBody, Shaft
from dynamics.shafts.shaft_position import OnShaft, on_length

# Laws of bearings that are not linear: what they can act on.


def _check_bearing_laws(
    bearings: Sequence[str],
    contacts: Sequence[RollingContact],
    curves: Sequence[SpringCurve],
    rolling: Sequence[RollingBearing],
    rotating: frozenset[str],
) -> None:
    """Every law has its own direction of one of `bearings`.

    `rotating` names the bearings of shafts described in a rotating frame.
    """
    fields = [
        *((f"rolling_contacts[{index}].bushing", part.bushing) for index, part in enumerate(contacts)),
        *((f"spring_curves[{index}].bushing", part.bushing) for index, part in enumerate(curves)),
    ]
    for place, name in fields:
        one_of(place, name, bearings)
    distinct("rolling_contacts", [part.bushing for part in contacts])
    distinct("spring_curves", [f"{part.bushing}.{part.direction}" for part in curves])
    for index, curve in enumerate(curves):
        if curve.bushing in rotating and curve.direction != "z":
            bound = '"z" on a shaft described in a carrier\'s frame, which turns against the bushing'
            raise InputError(f"spring_curves[{index}].direction", curve.direction, bound)
    for index, bearing in enumerate(rolling):
        _check_preload(f"rolling_bearings[{index}].axial_preload", bearing)


def _check_preload(field: str, bearing: RollingBearing) -> None:
    """Refuse an axial preload that no displacement of the rings makes."""
    try:
        row_law(bearing).shift  # noqa: B018 (computed and kept)
    except SolveError as error:
        raise InputError(field, bearing.axial_preload, "a force that the row carries", "Lower it.") from error


# Check of the positions of gears and bearings on their shafts.


def _check_positions(shafts: Sequence[Shaft], kind: str, parts: Sequence[OnShaft]) -> None:
    """Refuse a part of a `kind` ("gears", "bushings", "planet_bearings") that is off its shaft.

    Raises
    ------
    InputError
    """
    length = {shaft.name: shaft.length for shaft in shafts}
    for index, part in enumerate(parts):
        if not on_length(part.position, length[part.shaft]):
            ends = between(0.0, length[part.shaft], "m")
            bound = Text.of(f'on the shaft "{part.shaft}", ', ends, " from its left end")
            advice = "Lengthen the shaft, or move what sits on it."
            raise InputError(f"{kind}[{index}].position", part.position, bound, advice)


ON_VIOLATION = ("repeat", "fail", "report")
TOLERANCES = (1e-6, 0.5)
SAMPLE_LIMIT = 2e7  # a run's states are held in memory
LEAST_RATE = 1000.0  # Hz, of an output whose rate is chosen


class _Named(Protocol):
    @property
    def name(self) -> str: ...


class Reference(Protocol):
    """The law that sets the speed of one shaft in the kinematic motion."""

    @property
    def shaft(self) -> str: ...  # noqa: D102
    @property
    def speed(self) -> TimeLaw | AngleLaw: ...  # noqa: D102
    @property
    def rigid(self) -> bool: ...  # noqa: D102


@dataclass(frozen=True)
class Scene:
    """A geared system and its run.

    Attributes
    ----------
    shafts, gears, bushings, planet_bearings, couplings, meshes, drives, free_rotations, loads : tuples
    speed_torques, housings, discs, rolling_bearings, forces, unbalances : tuples
        Parts, each with a name unique among its kind. Drives and free rotations together set the kinematic
        motion of all shafts: one for each independent speed of the gearing.
    rolling_contacts, spring_curves : tuples
        Nonlinear laws of bearings; each names its bushing or planet bearing, which sits in no housing without
        mass.
    duration : float
        s.
    gravity : tuple of three floats
        Its acceleration in the fixed frame, m/s^2. Across the axis only without rotating frames.
    effects : mapping of str to str
        Effect name to ``"auto"``, ``"on"`` or ``"off"``; effects that are not named are ``"auto"``.
    outputs : Outputs
    integration : Integration
    on_violation : str
        If a run or a study violates an assumption: ``"repeat"`` runs again with the automatic effect that it
        needs, and raises if the result is invalid and no effect corrects it; ``"fail"`` raises at any
        violation, ``"report"`` reports it in the ledger's checks.
    tolerance : float or None
        Relative change of mean and peak-to-peak transmission error and of bearing forces that neglected
        automatic effects may cause in a run; None: effects are as the scene calls for them.
    highest_frequency : float or None
        Hz to which flexible shafts are resolved; None: half the output rate.
    """

    shafts: tuple[Shaft, ...]
    gears: tuple[GearBody, ...]
    meshes: tuple[GearMesh, ...]
    drives: tuple[ImposedRotation, ...]
    duration: float
    bushings: tuple[Bushing, ...] = ()
    loads: tuple[LoadTorque, ...] = ()
    planet_bearings: tuple[PlanetBearing, ...] = ()
    free_rotations: tuple[FreeRotation, ...] = ()
    couplings: tuple[Coupling, ...] = ()
    speed_torques: tuple[SpeedTorque, ...] = ()
    housings: tuple[Housing, ...] = ()
    rolling_contacts: tuple[RollingContact, ...] = ()
    spring_curves: tuple[SpringCurve, ...] = ()
    discs: tuple[DiscBody, ...] = ()
    rolling_bearings: tuple[RollingBearing, ...] = ()
    forces: tuple[AppliedForce, ...] = ()
    unbalances: tuple[Unbalance, ...] = ()
    gravity: tuple[float, float, float] = (0.0, 0.0, 0.0)
    effects: Mapping[str, str] = field(default_factory=dict)
    outputs: Outputs = field(default_factory=Outputs)
    integration: Integration = field(default_factory=Integration)
    on_violation: str = "repeat"
    tolerance: float | None = None
    highest_frequency: float | None = None

    def __post_init__(self) -> None:
        not_negative("duration", self.duration)
        one_of("on_violation", self.on_violation, ON_VIOLATION)
        if self.tolerance is not None:
            within("tolerance", self.tolerance, *TOLERANCES)
        if self.highest_frequency is not None:
            positive("highest_frequency", self.highest_frequency)
        check_samples(self.duration, self.outputs.sample_rate or LEAST_RATE)
        for kind in KINDS:
            distinct(kind, [part.name for part in getattr(self, kind)])
        shafts, gears = _names(self.shafts), _names(self.gears)
        distinct("planet_bearings", _names((*self.ground_bearings, *self.planet_bearings)))
        for kind in ON_A_SHAFT:
            for index, part in enumerate(getattr(self, kind)):
                one_of(f"{kind}[{index}].shaft", part.shaft, shafts)
        check_force_shafts(self.forces, shafts)
        placed = ("gears", "discs", "bushings", "rolling_bearings", "planet_bearings")
        for kind in (*placed, "forces", "unbalances"):
            _check_positions(self.shafts, kind, getattr(self, kind))
        for index, mesh in enumerate(self.meshes):
            one_of(f"meshes[{index}].driver", mesh.driver, gears)
            one_of(f"meshes[{index}].driven", mesh.driven, gears)
        for index, coupling in enumerate(self.couplings):
            for side in ("first", "second"):
                one_of(f"couplings[{index}].{side}", getattr(coupling, side), shafts)
        self._check_references()
        check_frames(self.shafts, self.planet_bearings)
        for kind in ("bushings", "rolling_bearings"):
            check_on_axis(self.shafts, kind, getattr(self, kind))
        check_gravity(self.shafts, self.gravity)
        check_couplings(self.shafts, self.couplings)
        check_housings(
            self.shafts,
            self.ground_bearings,
            self.housings,
            frozenset(law.bushing for law in self.bearing_laws),
        )
        rotating = {shaft.name for shaft in self.shafts if shaft.frame is not None}
        _check_bearing_laws(
            [bearing.name for bearing in (*self.bushings, *self.planet_bearings)],
            self.rolling_contacts,
            self.spring_curves,
            self.rolling_bearings,
            frozenset(bushing.name for bushing in self.bushings if bushing.shaft in rotating),
        )

    def _check_references(self) -> None:
        """Something turns."""
        if not self.references:
            suggestion = "Add a drive, or a free rotation where only torques move the train."
            raise InputError("drives", 0, "at least one drive or free rotation", suggestion)
        if not self.free_rotations and all(drive.speed.extreme == 0.0 for drive in self.drives):
            suggestion = "Its sign sets the driving flank. If torques move it, add a free rotation."
            raise InputError("drives[0].speed", 0.0, "not zero all the time", suggestion)

    @property
    def references(self) -> tuple[Reference, ...]:
        """The laws of the kinematic motion: the drives, then the free rotations."""
        return (*self.drives, *self.free_rotations)

    @property
    def ground_bearings(self) -> tuple[Bushing, ...]:
        """All bearings between shafts and the ground: bushings, and those that rolling bearings act at."""
        return (*self.bushings, *(bearing.support for bearing in self.rolling_bearings))

    @property
    def bearing_laws(self) -> tuple[BearingLaw, ...]:
        """All that bearings do which is not linear, rolling elements averaged."""
        return self.laws_with(frozenset())

    def laws_with(self, passing: frozenset[str]) -> tuple[BearingLaw, ...]:
        """Return all that bearings do which is not linear; the elements of those `passing` one by one."""
        rows = (row_law(bearing, bearing.name in passing) for bearing in self.rolling_bearings)
        return (*self.rolling_contacts, *self.spring_curves, *rows)

    def gear(self, name: str) -> GearBody:
        """Return the gear called `name`."""
        return next(gear for gear in self.gears if gear.name == name)

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
        return _names(self.shafts).index(name)


def check_samples(duration: float, rate: float) -> None:
    """Refuse a run of too many samples.

    Raises
    ------
    InputError
        Naming its duration.
    """
    if duration * rate > SAMPLE_LIMIT:
        bound = at_most(SAMPLE_LIMIT / rate, "s", note=f", {SAMPLE_LIMIT:g} samples at {rate:g} Hz")
        suggestion = "Shorten the run, or lower outputs.mesh_orders or outputs.sample_rate."
        raise InputError("duration", duration, bound, suggestion)


def _names(parts: Iterable[_Named]) -> list[str]:
    return [part.name for part in parts]
