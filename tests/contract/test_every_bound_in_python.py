"""Every bound of the libraries' own objects, told to a caller from Python: in SI, and it holds as printed."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from dataclasses import fields, is_dataclass, replace
from typing import Any

import pytest
from bound_walk import HIGH, LONGEST_CHAIN, LOW, next_typed

from bounds import RefusedValue
from dynamics.bearings import Bushing
from dynamics.forces import RollingContact
from dynamics.joints import Coupling
from dynamics.loads import LoadTorque, TimeLaw
from dynamics.meshes import CoastFlank, GearMesh
from dynamics.meshes.stiffness_table import straight_table
from dynamics.scene import Integration, Outputs
from dynamics.shafts import BeamSection, GearBody, Inertia, hollow_cylinder
from dynamics.shafts import Shaft as TurningShaft
from fe_contact.geometry import BoreSeat, FlankModification, Gear, GearBlank, GearPair, Key, RingGear, Shaft
from lineofaction.gearbox.problems import Fault

FAR = 10.0**6
"""Far off in SI: lengths of a thousand kilometers."""

PINION = Gear(
    20,
    4e-3,
    25e-3,
    40e-3,
    tip_diameter=88e-3,
    modification=FlankModification(tip_relief=2e-5, tip_relief_length=1e-3),
    blank=GearBlank(8e-3, 1e-2, 45e-3),
    seat=BoreSeat(tangential_foundation=1e13, width=2e-2, key=Key(12e-3)),
)
WHEEL = Gear(20, 4e-3, 25e-3, 40e-3)
OBJECTS: dict[str, Any] = {
    "gear": PINION,
    "ring gear": RingGear(60, 4e-3, 25e-3, 0.28, addendum_coefficient=0.75),
    "pair": GearPair(PINION, WHEEL, 80.2e-3, shafts=(Shaft(0.2, 0.04, 0.06, 4e8), None)),
    "beam": BeamSection(0.2, 0.04, 0.01),
    "turning shaft": TurningShaft("input", 0.2, sections=(BeamSection(0.2, 0.04),)),
    "gear body": GearBody("pinion", "input", 0.1, 20, 0.0376, 0.025, 0.0, hollow_cylinder(0.08, 0.025, 0.04)),
    "inertia": Inertia(2.0, 1e-3, 7e-3),
    "bushing": Bushing("left", "input", 0.0, 1e8, 1e8, 1e3, 1e3),
    "rolling contact": RollingContact("left", 5e8, 1.5, 2e-5, 500.0),
    "coast flank": CoastFlank(8e-5, 0.49),
    "mesh": GearMesh("mesh", "a", "b", straight_table(1e8), damping=1e3, nominal_force=2e3, friction=0.05),
    "load": LoadTorque("brake", "output", TimeLaw.constant(100.0)),
    "coupling": Coupling("joint", "a", "b", 5e4, 5.0),
    "outputs": Outputs(2e4),
    "integration": Integration(fixed_step=1e-5),
}


def numbers(thing: Any, path: tuple[str, ...] = ()) -> Iterator[tuple[tuple[str, ...], type]]:
    for field in fields(thing):
        value = getattr(thing, field.name)
        if is_dataclass(value):
            yield from numbers(value, (*path, field.name))
        elif isinstance(value, int | float) and not isinstance(value, bool):
            yield (*path, field.name), type(value)


def refusal(thing: Any, path: tuple[str, ...], value: float) -> Fault | None:
    """Return why an object is refused that has another value at a path; the error as Python shows it."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            changed(thing, path, value)
    except RefusedValue as error:
        assert f"{error.field} = " in str(error) and f": must be {error.bound}" in str(error)
        return Fault(error.field, error.value, str(error.bound), str(error.suggestion))
    return None


def same(told: str, path: str) -> bool:
    """Whether an error's field is a path: either may leave out what it is inside of."""
    names, wanted = told.split("."), path.split(".")
    shared = min(len(names), len(wanted))
    return names[-shared:] == wanted[-shared:]


def changed(thing: Any, path: tuple[str, ...], value: float) -> Any:
    """Return a dataclass with one number changed, however deep."""
    name, *rest = path
    return replace(thing, **{name: changed(getattr(thing, name), tuple(rest), value) if rest else value})


@pytest.mark.parametrize("name", OBJECTS)
def test_the_number_of_a_bound_is_accepted_as_it_is_printed(name: str) -> None:
    told = 0
    for path, kind in numbers(OBJECTS[name]):
        for end, far in ((LOW, -FAR), (HIGH, FAR)):
            value: float | None = kind(far)
            seen: list[str] = []
            while value is not None and len(seen) < LONGEST_CHAIN:
                fault = refusal(OBJECTS[name], path, value)
                if fault is None or not same(fault.field, ".".join(path)):
                    break
                assert fault.value == pytest.approx(value, rel=1e-12), fault
                assert fault.bound not in seen, f"{path} is told the same again: {fault}"
                seen.append(fault.bound)
                value = next_typed(fault, end, kind)
            assert len(seen) < LONGEST_CHAIN, seen
            told += len(seen)
    assert told >= 1
