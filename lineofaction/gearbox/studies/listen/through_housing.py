"""Runs heard through the housings of a scene: at a point of one, or at a microphone in the air."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from dynamics.acoustics import Recording
from dynamics.housings import scene_housing
from dynamics.joints import Housing
from dynamics.noise import pressure_recording, velocity_recording
from dynamics.results import RunResult
from dynamics.types import FloatArray
from lineofaction.gearbox.convert.case import boundary_errors
from lineofaction.gearbox.convert.housings import HousedScene
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.units import MM

if TYPE_CHECKING:
    from dynamics.housings import ReducedHousing

PRINCIPAL = "principal"
DIRECTIONS = ("x", "y", "z", PRINCIPAL)
ADVICE = (
    "Give a housing by step_file, mesh_file or modes_file: matrices alone do not say what the air touches."
)
SAME = 1e-6
"""Largest difference between matrices of the same housing, of their largest entry."""


@dataclass(frozen=True)
class SceneHousings:
    """The reduced housings of a scene by name, and the bearings in the order of their seats."""

    housings: Mapping[str, ReducedHousing]
    bearings: Mapping[str, tuple[str, ...]]

    @classmethod
    def of(cls, subject: HousedScene) -> SceneHousings:
        """Return those of a scene."""
        return cls(subject.housings, {part.name: part.bushings for part in subject.inputs.housings})

    def pressure(self, run: RunResult, microphone_mm: tuple[float, ...]) -> Recording:
        """Return the sound pressure at a microphone in the scene's frame, the sum over the housings.

        Raises
        ------
        BadInput
            The microphone is not in the air, the run has no forces on bearings of a housing, or no housing
            has a surface.
        """
        position = np.array(microphone_mm) * MM
        with boundary_errors():
            heard = [
                pressure_recording(body, run, position, self.bearings[name])
                for name, body in self.housings.items()
                if body.surface is not None
            ]
        if not heard:
            raise silent(list(self.bearings))
        quantity = "; ".join(dict.fromkeys(one.quantity for one in heard))
        return replace(heard[0], samples=np.sum([one.samples for one in heard], axis=0), quantity=quantity)

    def velocity(self, run: RunResult, point: str, direction: str = "") -> Recording:
        """Return the velocity of a named point along one of `DIRECTIONS`, by default the principal one.

        Raises
        ------
        BadInput
            No housing or several have such a point, or there is no such direction.
        """
        owners = [name for name, body in self.housings.items() for one in body.points if one.name == point]
        require_point(point, [one.name for body in self.housings.values() for one in body.points])
        if direction and direction not in DIRECTIONS:
            raise BadInput.of("direction", direction, f"one of {', '.join(DIRECTIONS)}")
        axis = None if direction in ("", PRINCIPAL) else np.eye(3)[DIRECTIONS.index(direction)]
        with boundary_errors():
            return velocity_recording(
                self.housings[owners[0]], run, point, axis, bearings=self.bearings[owners[0]]
            )

    def strangers(self, run: RunResult) -> tuple[str, ...]:
        """Return the names of housings in which a run did not move: its forces lack what they do to them."""
        return other_housings([scene_housing(body, name) for name, body in self.housings.items()], run)


def silent(housings: list[str]) -> BadInput:
    """Return the error of housings of which none has a surface, by their names."""
    return BadInput.of("housings", housings, "at least one with a surface", ADVICE)


def require_surface(scene: SceneInput) -> None:
    """Refuse a scene of whose housings none can have a surface; raises `BadInput`."""
    if not any(part.is_solid or part.modes_file is not None for part in scene.housings):
        raise silent([part.name for part in scene.housings])


def require_point(point: str, names: Sequence[str]) -> None:
    """Refuse a point that is not one of the names, or several; raises `BadInput`."""
    if names.count(point) != 1:
        bound = f"the name of one point; known: {', '.join(names) or 'none'}"
        raise BadInput.of("point", point, bound, "Name points in the housing's table of the scene.")


def other_housings(housings: Iterable[Housing], run: RunResult) -> tuple[str, ...]:
    """Return the names of housings with mass in which a run did not move."""
    moved = {part["name"]: part for part in run.case.get("housings", ())}
    massive = (housing for housing in housings if housing.mass is not None)
    return tuple(housing.name for housing in massive if not _same(housing, moved.get(housing.name)))


def _same(housing: Housing, part: dict[str, Any] | None) -> bool:
    """Whether a part of a stored scene has a housing's matrices at the seats: signs of modes are free."""
    if part is None or part["mass"] is None:
        return False
    seats = slice(len(housing.stiffness) - housing.modal_coordinates)
    for name in ("stiffness", "mass", "damping"):
        mine, other = (_matrix(of[name])[seats, seats] for of in (vars(housing), part))
        if mine.shape != other.shape or np.any(np.abs(mine - other) > SAME * np.abs(mine).max(initial=0.0)):
            return False
    return True


def _matrix(values: Any) -> FloatArray:
    """Return a matrix as an array, (0, 0) without one."""
    return np.zeros((0, 0)) if values is None else np.array(values, dtype=float)
