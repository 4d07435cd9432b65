"""Laws of bearings that are not linear: what they can act on."""

from __future__ import annotations

from collections.abc import Sequence

from dynamics.checks import distinct, one_of
from dynamics.errors import InputError
from dynamics.forces import RollingContact, SpringCurve
from dynamics.joints import Bushing, PlanetBearing


def check_bearing_laws(
    bearings: Sequence[Bushing | PlanetBearing],
    contacts: Sequence[RollingContact],
    curves: Sequence[SpringCurve],
    housed: frozenset[str],
    rotating: frozenset[str],
) -> None:
    """Every law has its own direction of a bearing that exists, on rigid ground or on a pin.

    `housed` names the bushings in a housing, `rotating` those of shafts described in a rotating frame.
    """
    names = [bearing.name for bearing in bearings]
    laws: list[tuple[str, Sequence[RollingContact | SpringCurve]]] = [
        ("rolling_contacts", contacts),
        ("spring_curves", curves),
    ]
    for kind, parts in laws:
        for index, part in enumerate(parts):
            field = f"{kind}[{index}].bushing"
            one_of(field, part.bushing, names)
            if part.bushing in housed:
                bound = "a bushing outside of housings, which are condensed with linear bushings"
                raise InputError(field, part.bushing, bound, "Take it out of the housing.")
    distinct("rolling_contacts", [part.bushing for part in contacts])
    distinct("spring_curves", [f"{part.bushing}.{part.direction}" for part in curves])
    for index, curve in enumerate(curves):
        if curve.bushing in rotating and curve.direction != "z":
            bound = '"z" on a shaft described in a carrier\'s frame, which turns against the bushing'
            raise InputError(f"spring_curves[{index}].direction", curve.direction, bound)
