"""Check of the positions of gears and bearings on their shafts."""

from __future__ import annotations

from collections.abc import Sequence

from bounds import Text, between
from dynamics.bodies import Shaft
from dynamics.bodies.shaft_position import OnShaft, on_length
from dynamics.errors import InputError


def check_positions(shafts: Sequence[Shaft], kind: str, parts: Sequence[OnShaft]) -> None:
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
