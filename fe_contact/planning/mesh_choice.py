"""Choice of mesh and slices for a tolerance or a time, by the models of error and of cost."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from bounds import engineering
from fe_contact.allowed_error import AllowedError
from fe_contact.planning.error_model import ExpectedError
from fe_contact.types import Json


@dataclass(frozen=True)
class MeshOption:
    """A mesh with its slices.

    Attributes
    ----------
    level : str
        "draft", "standard" or "fine".
    slices : int
        Of the face; 1 in the plane.
    error : ExpectedError
    effort : float
        Work of a run, in CPU seconds of the host on which the models were measured and with nothing in the
        cache: equal on every host, so that the choice is.
    """

    level: str
    slices: int
    error: ExpectedError
    effort: float

    @property
    def name(self) -> str:
        """In words."""
        return self.level if self.slices == 1 else f"{self.level}, {self.slices} slices"


@dataclass(frozen=True)
class MeshChoice:
    """A mesh with its slices, the reason, and whether the request can be met.

    Attributes
    ----------
    option : MeshOption
    met : bool
        Whether the models promise what was requested.
    reason : str
        In words.
    """

    option: MeshOption
    met: bool
    reason: str

    @property
    def level(self) -> str:
        """Level of the mesh."""
        return self.option.level

    @property
    def slices(self) -> int:
        """Slices of the face; 1 in the plane."""
        return self.option.slices

    def to_json(self) -> Json:
        """Return plain JSON."""
        return {"level": self.level, "slices": self.slices, "met": self.met, "reason": self.reason}


def mesh_for_tolerance(tolerance: AllowedError, options: Sequence[MeshOption]) -> MeshChoice:
    """Return the option of least effort whose error is expected to be within the tolerance.

    Expected errors are parts of the size of each quantity that the tolerance counts by.
    If there is none: where it is the model that is beyond it, the one of least effort whose own error is
    within it, as no mesh mends the model; else the most exact one. Said in either case.
    """
    within = [option for option in options if option.error.total <= tolerance.relative]
    if within:
        best = min(within, key=_effort)
        return MeshChoice(best, True, f"expected error {_percent(best.error.total)} %")
    enough = [option for option in options if option.error.discretization <= tolerance.relative]
    beyond = min(option.error.lasting for option in options) > tolerance.relative
    best = min(enough, key=_effort) if enough and beyond else min(options, key=lambda o: o.error.total)
    error = best.error
    parts = f"mesh {_percent(error.discretization)} %, model {_percent(error.lasting)} %"
    return MeshChoice(best, False, f"no mesh is expected within {tolerance.words} ({parts})")


def mesh_for_time(
    budget: float, options: Sequence[MeshOption], seconds: Callable[[MeshOption], float]
) -> MeshChoice:
    """Return the most exact option that is predicted to fit into `budget` CPU seconds, else the cheapest."""
    for option in sorted(options, key=lambda o: (o.error.total, o.effort)):
        predicted = seconds(option)
        if predicted <= budget:
            return MeshChoice(option, True, f"predicted {engineering(predicted, 2)} CPU s")
    least = min(options, key=_effort)
    reason = f"even the fastest mesh is predicted to take {engineering(seconds(least), 2)} CPU s"
    return MeshChoice(least, False, reason)


def _effort(option: MeshOption) -> float:
    """Work of a run."""
    return option.effort


def _percent(value: float) -> str:
    """In per cent, two digits."""
    return engineering(100.0 * value, 2)
