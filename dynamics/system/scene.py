"""The scene: everything a run needs, frozen, in SI units."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Protocol

from dynamics.bodies import GearBody, Shaft
from dynamics.checks import distinct, integer, not_negative, one_of, positive
from dynamics.errors import InputError
from dynamics.forces import GearMesh, LoadTorque
from dynamics.joints import Bushing, ImposedRotation

METHODS = ("implicit", "explicit")
SAMPLE_LIMIT = 2e7  # a run's states are held in memory


@dataclass(frozen=True)
class Outputs:
    """What to store.

    Attributes
    ----------
    sample_rate : float
        Hz of the uniform output grid.
    bearing_forces : bool
        Store the three force components of every bushing.
    displacements : bool
        Store displacement and velocity of every freedom.
    energy_audit : bool
        Integrate the powers and close the balance at the end (a quarter more time).
    """

    sample_rate: float = 20e3
    bearing_forces: bool = True
    displacements: bool = False
    energy_audit: bool = True

    def __post_init__(self) -> None:
        positive("sample_rate", self.sample_rate)


@dataclass(frozen=True)
class Integration:
    """How to integrate in time.

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
            raise InputError("largest_step", self.largest_step, f"above smallest_step {self.smallest_step:g}")
        if self.fixed_step is not None:
            positive("fixed_step", self.fixed_step)
        integer("step_limit", self.step_limit, 1, 2**62)


class _Named(Protocol):
    @property
    def name(self) -> str: ...


@dataclass(frozen=True)
class Scene:
    """A geared system and the run to make with it.

    Attributes
    ----------
    shafts, gears, bushings, meshes, drives, loads : tuples
        Parts, each with a name unique among its kind. One drive for now: it sets the kinematic motion of
        all shafts that gears join to its own.
    duration : float
        s.
    effects : mapping of str to str
        Effect name to ``"auto"``, ``"on"`` or ``"off"``; what is not named is ``"auto"``.
    outputs : Outputs
    integration : Integration
    """

    shafts: tuple[Shaft, ...]
    gears: tuple[GearBody, ...]
    meshes: tuple[GearMesh, ...]
    drives: tuple[ImposedRotation, ...]
    duration: float
    bushings: tuple[Bushing, ...] = ()
    loads: tuple[LoadTorque, ...] = ()
    effects: Mapping[str, str] = field(default_factory=dict)
    outputs: Outputs = Outputs()
    integration: Integration = Integration()

    def __post_init__(self) -> None:
        not_negative("duration", self.duration)
        if self.duration * self.outputs.sample_rate > SAMPLE_LIMIT:
            bound = f"at most {SAMPLE_LIMIT:g} samples at {self.outputs.sample_rate:g} Hz"
            raise InputError("duration", self.duration, bound, "Shorten the run or lower the sample rate.")
        for kind in ("shafts", "gears", "bushings", "meshes", "drives", "loads"):
            distinct(kind, [part.name for part in getattr(self, kind)])
        shafts, gears = _names(self.shafts), _names(self.gears)
        for kind in ("gears", "bushings", "drives", "loads"):
            for index, part in enumerate(getattr(self, kind)):
                one_of(f"{kind}[{index}].shaft", part.shaft, shafts)
        for index, mesh in enumerate(self.meshes):
            one_of(f"meshes[{index}].driver", mesh.driver, gears)
            one_of(f"meshes[{index}].driven", mesh.driven, gears)
        self._check_drive()

    def _check_drive(self) -> None:
        """One drive, and it turns."""
        if len(self.drives) != 1:
            raise InputError("drives", len(self.drives), "exactly one drive")
        if self.drives[0].speed.extreme == 0.0:
            raise InputError(
                "drives[0].speed", 0.0, "not zero all the time", "Its sign sets the driving flank."
            )

    def gear(self, name: str) -> GearBody:
        """Return the gear called `name`."""
        return next(gear for gear in self.gears if gear.name == name)

    def shaft_index(self, name: str) -> int:
        """Return the place of the shaft called `name`."""
        return _names(self.shafts).index(name)


def _names(parts: Iterable[_Named]) -> list[str]:
    """Names of `parts`, in order."""
    return [part.name for part in parts]
