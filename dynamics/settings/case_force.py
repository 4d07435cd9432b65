"""A force of a scene under a load case."""

from __future__ import annotations

from dataclasses import dataclass

from bounds import Declared, Kind, between, declared, described
from dynamics.checks import declared_fields, finite
from dynamics.errors import InputError

Vector = tuple[float, float, float]

_FACTOR = Declared(
    Kind.RATIO,
    "",
    between(-1e6, 1e6),
    "Factor on the scene's force and moment, in place of values of its own",
    0.5,
)
_ONE = "Give the case's own force and moment, or a factor on the scene's."


@described
@dataclass(frozen=True)
class CaseForce:
    """What the force `name` of a scene is under a load case.

    Its own `force` (N) and `moment` (N m), about and along the axes of the scene's; one that is left out is
    as in the scene. Or a factor on both. Where it acts, its course and what it turns with are the scene's.
    """

    name: str
    force: Vector | None = None
    moment: Vector | None = None
    factor: float | None = declared(None, _FACTOR)

    def __post_init__(self) -> None:
        declared_fields(self)
        own = {"force": self.force, "moment": self.moment}
        stated = {name: vector for name, vector in own.items() if vector is not None}
        for name, vector in stated.items():
            for axis, value in zip("xyz", vector, strict=True):
                finite(f"{name}.{axis}", value)
        if stated and self.factor is not None:
            raise InputError("factor", self.factor, f"left out if a {min(stated)} is given", _ONE)
        if not stated and self.factor is None:
            raise InputError("force", None, "given, or a moment, or a factor", _ONE)
