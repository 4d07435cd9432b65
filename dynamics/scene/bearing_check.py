"""Laws of bearings that are not linear: what they can act on."""

from __future__ import annotations

from collections.abc import Sequence

from dynamics.checks import distinct, one_of
from dynamics.errors import InputError, SolveError
from dynamics.forces import RollingContact, SpringCurve
from dynamics.joints import RollingBearing
from dynamics.rolling_bearings.row_law import row_law


def check_bearing_laws(
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
    for field, name in fields:
        one_of(field, name, bearings)
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
