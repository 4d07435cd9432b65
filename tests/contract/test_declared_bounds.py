"""Every declared field of both libraries refuses, by its name, whatever its declaration does not accept."""

import importlib
import inspect
import math
import pkgutil
from dataclasses import MISSING, fields, is_dataclass, replace

import pytest
from spur_gears import make_gear, make_ring

import dynamics
import fe_contact
from bounds import Choice, Kind, RefusedValue, declarations
from dynamics import Inertia, TimeLaw, hollow_cylinder
from dynamics.bearings import BallBearing
from dynamics.housings import MeshedHousing
from dynamics.meshes.stiffness_table import straight_table
from dynamics.settings.load_case import CaseForce
from dynamics.solid_housing import Material
from fe_contact import GearPair, InternalGearPair, RingGear

UNDECLARED = {
    **dict.fromkeys(("name", "shaft", "first", "driver"), "a"),
    **dict.fromkeys(("second", "driven"), "b"),
    **dict.fromkeys(("speed", "torque"), TimeLaw.constant(1.0)),
    "table": straight_table(1e8),
    "housing_material": Material(70e9, 0.33, 2700.0, 23e-6),
    "row": BallBearing(8, 9e-3, 53.5e-3),
    "bushings": ("a",),
    "stiffness": ((1e8, 0.0, 0.0), (0.0, 1e8, 0.0), (0.0, 0.0, 1e8)),
    "position": (0.0, 0.0, 0.0),
    "axis": (0.0, 0.0, 1.0),
    "teeth": 20,
    "base_radius": 0.0376,
    "face_width": 0.025,
    "base_helix_angle": 0.0,
    "inertia": hollow_cylinder(0.08, 0.025, 0.04),
}
"""What required fields without a declaration are given; those with one have their example."""
THINGS = {
    RingGear: make_ring(),
    GearPair: GearPair(make_gear(), make_gear(), 0.08),
    InternalGearPair: InternalGearPair(make_gear(30), make_ring(80, addendum_coefficient=0.8), 0.1),
    CaseForce: CaseForce("a", factor=1.0),
}
"""Things whose fields depend on each other."""


def declared_kinds():
    """Yield the dataclasses that check declared fields; bases leave that to what is made of them."""
    for package in (fe_contact, dynamics):
        for module in pkgutil.walk_packages(package.__path__, f"{package.__name__}."):
            found = vars(importlib.import_module(module.name)).values()
            kinds = (kind for kind in found if inspect.isclass(kind) and kind.__module__ == module.name)
            checked = (kind for kind in kinds if is_dataclass(kind) and "__post_init__" in vars(kind))
            yield from (kind for kind in checked if declarations(kind) and kind is not MeshedHousing)


def sample(kind):
    if kind in THINGS:
        return THINGS[kind]
    values = UNDECLARED | {name: fact.example for name, fact in declarations(kind).items()}
    required = [field.name for field in fields(kind) if field.default is field.default_factory is MISSING]
    return kind(**{name: values.get(name) for name in required})


def wrong_values(kind, declaration):
    bound = declaration.bound
    if isinstance(bound, Choice):
        return ["no such name", 3]
    counted = declaration.kind is Kind.COUNT
    values = [math.nan, math.inf, "1", True]
    for closed, opened, way in ((bound.ge, bound.gt, -1), (bound.le, bound.lt, 1)):
        if opened is not None:
            values.append(opened)
        elif closed is not None and not (kind is Inertia and way == 1):  # several bodies weigh more than one
            values.append(closed + way * (1 if counted else max(1e-9, 1e-6 * abs(closed))))
    return [*values, bound.ge + 0.5] if counted else values


def test_every_declared_field_refuses_what_it_does_not_accept_by_its_name():
    refused = 0
    for kind in dict.fromkeys(declared_kinds()):
        thing = sample(kind)
        for name, declaration in declarations(kind).items():
            for value in wrong_values(kind, declaration) if declaration.bound is not None else ():
                with pytest.raises(RefusedValue) as caught:
                    replace(thing, **{name: value})
                assert caught.value.field == name, (kind, name, value, str(caught.value))
                assert str(caught.value.bound)
                refused += 1
    assert refused > 1000
