"""Small gears and their condensed rings."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest

from fe_contact.geometry import Gear, Toothing
from fe_contact.mesh import MeshRecipe

MakeGear = Callable[..., Gear]


@pytest.fixture(scope="module", autouse=True)
def condensed_once() -> None:
    """Condense each time: that is what these tests are about."""


@pytest.fixture(scope="session")
def make_gear() -> MakeGear:
    """Make a gear of module 4 mm whose tooth sectors reach down to the bore."""

    def make(**fields: Any) -> Gear:
        defaults = {"teeth": 20, "normal_module": 4e-3, "face_width": 25e-3, "bore_diameter": 40e-3}
        return Gear(**(defaults | fields))

    return make


@pytest.fixture(scope="session")
def coarse() -> Callable[..., MeshRecipe]:
    """Make a recipe coarse enough for tests of laws that hold on every mesh."""

    def make(gear: Toothing, **fields: Any) -> MeshRecipe:
        m = gear.normal_module
        recipe = MeshRecipe.standard(gear)
        return replace(recipe, flank_size=0.2 * m, tip_size=0.1 * m, fillet_size=0.2 * m, **fields)

    return make
