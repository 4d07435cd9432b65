"""Random feasible gear pairs with loads, as a case has them: what most bodies of the API are about."""

from __future__ import annotations

from typing import Any

from hypothesis import assume
from hypothesis import strategies as st

from fe_contact.errors import InfeasibleGeometry
from fe_contact.geometry import Gear, GearPair, InternalGearPair, RingGear
from lineofaction.gearbox.schemas.case import OF_PAIR
from lineofaction.gearbox.schemas.declared import figures

Json = dict[str, Any]

RACK = ("normal_module", "normal_pressure_angle", "helix_angle")
GEAR = ("teeth", "face_width", "bore_diameter", "rim_diameter", "profile_shift_coefficient")
HEIGHTS = ("addendum_coefficient", "dedendum_coefficient")
LINE_LOADS = st.floats(2e6, 4e7)
"""Force over face width and module, Pa."""


@st.composite
def cases(draw: st.DrawFn) -> Json:
    """Draw a pair, one to four torques and a model."""
    pair: Any = draw(external_pairs() | internal_pairs())
    width, module = pair.pinion.face_width, pair.pinion.normal_module
    highest = draw(LINE_LOADS) * width * module * pair.pinion.base_radius
    torques = [float(f"{highest * share:.4g}") for share in (0.1, 0.3, 0.6, 1.0)]
    accuracy = draw(st.sampled_from(({}, {"level": "draft"}, {"tolerance": 0.02}, {"time_budget_s": 30.0})))
    return {
        "pair": _written(pair.pinion, OF_PAIR, RACK)
        | _written(pair, OF_PAIR, ("center_distance",))
        | {"pinion": _gear(pair.pinion), "wheel": _gear(pair.wheel)},
        "load": {"torque_n_m": torques[draw(st.integers(0, 3)) :]},
        "accuracy": accuracy,
    }


@st.composite
def external_pairs(draw: st.DrawFn) -> GearPair:
    """Draw two external gears, 0.01 to 0.08 modules further apart than without backlash."""
    rack = draw(_racks())
    pinion, wheel = (
        draw(_gears(rack | {"helix_angle": hand * rack["helix_angle"]}, 14, 100)) for hand in (1, -1)
    )
    return _apart(draw, pinion, wheel)


@st.composite
def internal_pairs(draw: st.DrawFn) -> InternalGearPair:
    """Draw a pinion in a ring gear of low teeth."""
    rack = draw(_racks())
    pinion = draw(_gears(rack, 16, 40))
    module, teeth = rack["normal_module"], pinion.teeth + draw(st.integers(25, 80))
    sizes = {"face_width": pinion.face_width, "rim_diameter": 1.3 * (teeth + 8) * module * 1.2}
    shift = draw(st.floats(-0.2, 0.2))
    try:
        ring = RingGear(
            teeth=teeth, profile_shift_coefficient=shift, addendum_coefficient=0.75, **(rack | sizes)
        )
    except InfeasibleGeometry:
        assume(False)
        raise
    return _apart(draw, pinion, ring)


@st.composite
def _racks(draw: st.DrawFn) -> dict[str, float]:
    """Draw a basic rack; half of them spur."""
    return {
        "normal_module": draw(st.floats(1e-3, 12e-3)),
        "normal_pressure_angle": draw(st.floats(0.3, 0.42)),
        "helix_angle": draw(st.sampled_from([0.0]) | st.floats(0.05, 0.55)),
    }


@st.composite
def _gears(draw: st.DrawFn, rack: dict[str, float], least: int, most: int) -> Gear:
    module, teeth = rack["normal_module"], draw(st.integers(least, most))
    sizes = {"face_width": draw(st.floats(4.0, 15.0)) * module, "bore_diameter": 0.4 * teeth * module}
    shift = draw(st.floats(0.4 if teeth < 17 else -0.2, 0.6))
    try:
        return Gear(teeth=teeth, profile_shift_coefficient=shift, **(rack | sizes))
    except InfeasibleGeometry:
        assume(False)
        raise


def _apart(draw: st.DrawFn, pinion: Gear, wheel: Any) -> Any:
    kind, sign = (InternalGearPair, -1.0) if isinstance(wheel, RingGear) else (GearPair, 1.0)
    more = sign * draw(st.floats(0.01, 0.08)) * pinion.normal_module
    try:
        return kind(pinion, wheel, kind(pinion, wheel).center_distance + more)
    except InfeasibleGeometry:
        assume(False)
        raise


def _gear(gear: Any) -> Json:
    heights = HEIGHTS if isinstance(gear, RingGear) else ()
    kind = {"internal": True} if isinstance(gear, RingGear) else {}
    return kind | _written(gear, figures(type(gear)), (*GEAR, *heights))


def _written(part: Any, declared: Any, names: tuple[str, ...]) -> Json:
    """Return some figures of a part by the names of the boundary, in its units."""
    return {
        figure.field: figure.own(getattr(part, figure.name)) for figure in declared if figure.name in names
    }
