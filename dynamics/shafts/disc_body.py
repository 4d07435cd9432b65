"""A rigid disc on a shaft that meshes with nothing: a flywheel, a coupling half, a rotor."""

from __future__ import annotations

from dataclasses import dataclass, field

from bounds import Declared, Kind, between, described
from dynamics.checks import declared_fields
from dynamics.shafts.inertia import Inertia

_POSITION = Declared(
    Kind.LENGTH, "m", between(-1000.0, 1000.0), "Center of mass along the shaft, from its left end", 0.1
)


@described
@dataclass(frozen=True)
class DiscBody:
    """A rigid body of revolution fixed on a `shaft`, its `name` unique among the discs.

    `inertia` is about its own center of mass, which lies on the axis at `position`, m from the shaft's left
    end.
    """

    name: str
    shaft: str
    position: float = field(metadata={Declared: _POSITION})
    inertia: Inertia = field(default_factory=Inertia)

    def __post_init__(self) -> None:
        declared_fields(self)
