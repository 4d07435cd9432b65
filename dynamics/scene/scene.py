"""The scene: everything a run needs, frozen, in SI units."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Protocol

from bounds import above, at_most
from dynamics.bodies import AngleLaw, GearBody, Shaft, TimeLaw
from dynamics.checks import distinct, integer, not_negative, one_of, positive, within
from dynamics.errors import InputError
from dynamics.forces import GearMesh, LoadTorque, RollingContact, SpeedTorque, SpringCurve
from dynamics.joints import Bushing, Coupling, FreeRotation, Housing, ImposedRotation, PlanetBearing
from dynamics.parts import KINDS, ON_A_SHAFT
from dynamics.scene.bearing_check import check_bearing_laws
from dynamics.scene.frame_check import check_couplings, check_frames
from dynamics.scene.housing_check import check_housings
from dynamics.scene.position_check import check_positions

METHODS = ("implicit", "explicit")
ON_VIOLATION = ("repeat", "fail", "report")
RECEIPTS = ("full", "minimal")
TOLERANCES = (1e-6, 0.5)
SAMPLE_LIMIT = 2e7  # a run's states are held in memory
MOST_ORDERS = 1000
LEAST_RATE = 1000.0  # Hz, of an output whose rate is chosen


@dataclass(frozen=True)
class Outputs:
    """The outputs that a run stores.

    Attributes
    ----------
    sample_rate : float or None
        Hz of the uniform output grid; None: what the mesh orders and the highest resolved mode need.
    mesh_orders : int
        Multiples of the mesh frequency that the output is to hold at the highest speed of the run.
    anti_alias : bool
        Filter what is stored, so that nothing above half the rate folds into the output (see `Sampling`).
        False: points of the motion.
    bearing_forces : bool
        Store the force of every bearing, and its moment where a bearing holds tilt.
    displacements : bool
        Store displacement and velocity of every freedom.
    accelerations : bool
        Store the acceleration of the shaft at every bearing, and of every freedom if displacements are.
    energy_audit : bool
        Integrate the powers and close the balance at the end: a third to three quarters more time, more with
        more levels in the tables.
    receipt : str
        ``"full"``: measure the errors of time steps and tables in windows of the run (6 to 21 % more time).
        ``"minimal"``: state the tolerance only.
    """

    sample_rate: float | None = None
    bearing_forces: bool = True
    displacements: bool = False
    energy_audit: bool = True
    accelerations: bool = False
    receipt: str = "full"
    mesh_orders: int = 10
    anti_alias: bool = True

    def __post_init__(self) -> None:
        if self.sample_rate is not None:
            positive("sample_rate", self.sample_rate)
        integer("mesh_orders", self.mesh_orders, 1, MOST_ORDERS)
        one_of("receipt", self.receipt, RECEIPTS)


@dataclass(frozen=True)
class Integration:
    """Method and tolerances of the time integration.

    Attributes
    ----------
    method : str
        ``"implicit"``: singly diagonally implicit Runge-Kutta of order 4, L-stable. ``"explicit"``:
        Dormand-Prince of order 5, its check.
    tolerance : float
        Step error of the displacements wanted over the run, m rms (rotations times base radius).
    fixed_step : float or None
        s; None: chosen by error control.
    smallest_step, largest_step : float
        s; bounds of the error control.
    step_limit : int
        Number of steps after which a run ends as `RunStatus.STEP_LIMIT`.
    estimate_error : bool
        Run again at a tenth of the tolerance and report the difference of the transmission errors.
    """

    method: str = "implicit"
    tolerance: float = 1e-9
    fixed_step: float | None = None
    smallest_step: float = 1e-12
    largest_step: float = 1e-3
    step_limit: int = 100_000_000
    estimate_error: bool = False

    def __post_init__(self) -> None:
        one_of("method", self.method, METHODS)
        positive("tolerance", self.tolerance)
        positive("smallest_step", self.smallest_step)
        if self.largest_step <= self.smallest_step:
            bound = above(self.smallest_step, name="smallest_step")
            raise InputError("largest_step", self.largest_step, bound)
        if self.fixed_step is not None:
            positive("fixed_step", self.fixed_step)
        integer("step_limit", self.step_limit, 1, 2**62)


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
    """A geared system and the run to make with it.

    Attributes
    ----------
    shafts, gears, bushings, planet_bearings, couplings, meshes, drives, free_rotations, loads : tuples
    speed_torques, housings : tuples
        Parts, each with a name unique among its kind. Drives and free rotations together set the kinematic
        motion of all shafts: as many of them as the gearing leaves independent speeds.
    rolling_contacts, spring_curves : tuples
        What bearings do that is not linear: they name their bushing or planet bearing.
    duration : float
        s.
    effects : mapping of str to str
        Effect name to ``"auto"``, ``"on"`` or ``"off"``; what is not named is ``"auto"``.
    outputs : Outputs
    integration : Integration
    on_violation : str
        Where a run or a study shows that something it took for granted is wrong: ``"repeat"`` runs again
        with the automatic effect that it needs, and raises where the result is wrong and no effect mends it;
        ``"fail"`` raises at any, ``"report"`` says so in the ledger's checks.
    tolerance : float or None
        Relative change of mean and peak-to-peak transmission error and of bearing forces that automatic
        effects may make by being off; None: they are as the scene calls for them. Runs decide by it.
    highest_frequency : float or None
        Hz to which shafts that bend and twist are resolved; None: half the output rate.
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
    effects: Mapping[str, str] = field(default_factory=dict)
    outputs: Outputs = Outputs()
    integration: Integration = Integration()
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
        distinct("planet_bearings", _names((*self.bushings, *self.planet_bearings)))
        for kind in ON_A_SHAFT:
            for index, part in enumerate(getattr(self, kind)):
                one_of(f"{kind}[{index}].shaft", part.shaft, shafts)
        for kind in ("gears", "bushings", "planet_bearings"):
            check_positions(self.shafts, kind, getattr(self, kind))
        for index, mesh in enumerate(self.meshes):
            one_of(f"meshes[{index}].driver", mesh.driver, gears)
            one_of(f"meshes[{index}].driven", mesh.driven, gears)
        for index, coupling in enumerate(self.couplings):
            for side in ("first", "second"):
                one_of(f"couplings[{index}].{side}", getattr(coupling, side), shafts)
        self._check_references()
        check_frames(self.shafts, self.bushings, self.planet_bearings)
        check_couplings(self.shafts, self.couplings)
        check_housings(self.shafts, self.bushings, self.housings)
        rotating = {shaft.name for shaft in self.shafts if shaft.frame is not None}
        check_bearing_laws(
            (*self.bushings, *self.planet_bearings),
            self.rolling_contacts,
            self.spring_curves,
            frozenset(name for housing in self.housings for name in housing.bushings),
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

    def gear(self, name: str) -> GearBody:
        """Return the gear called `name`."""
        return next(gear for gear in self.gears if gear.name == name)

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
    """Names of `parts`, in order."""
    return [part.name for part in parts]
