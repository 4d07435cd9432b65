"""All force elements of a model, in their order: flanks, loads, rotating frames, couplings, bearings."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from dynamics.assembly.bearing_elements import bearing_elements, housed_elements
from dynamics.assembly.flank_elements import spatial_flank_elements
from dynamics.assembly.frame_elements import frame_coupling_elements, rotating_frame_elements
from dynamics.assembly.load_elements import applied_force_elements, speed_torque_elements, unbalance_elements
from dynamics.assembly.model import Model
from dynamics.forces.elements import Element
from dynamics.forces.laws import ElementLaws, Law

BY_LAW: tuple[tuple[Law, Callable[[Model], tuple[tuple[Element, ...], Any]]], ...] = (
    (Law.SPATIAL_FLANK, spatial_flank_elements),
    (Law.SPEED_TORQUE, speed_torque_elements),
    (Law.APPLIED_FORCE, applied_force_elements),
    (Law.UNBALANCE, unbalance_elements),
    (Law.ROTATING_FRAME, rotating_frame_elements),
    (Law.FRAME_COUPLING, frame_coupling_elements),
    (Law.LINEAR_BEARING, housed_elements),
)
"""The functions that lay out the elements of a law and their arrays, in the order of the elements."""


def force_elements(model: Model) -> tuple[tuple[Element, ...], ElementLaws]:
    """Return the elements of a model and their laws: driving flanks first, nonlinear bearings last."""
    laws: dict[str, Any] = {"flank": model.flanks.law}
    elements: list[Element] = []
    for law, lay_out in BY_LAW:
        added, laws[law.name.lower()] = lay_out(model)
        elements += added
    on_bearings, bearing_laws = bearing_elements(model)
    return (*elements, *on_bearings), ElementLaws(**laws, **bearing_laws)
