"""Gears to test with."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from fe_contact.geometry import Gear

MakeGear = Callable[..., Gear]


@pytest.fixture
def make_gear() -> MakeGear:
    """Make a gear of module 4 mm, 25 mm wide, with a small bore."""

    def make(teeth: int = 20, **fields: Any) -> Gear:
        defaults = {"normal_module": 4e-3, "face_width": 25e-3, "bore_diameter": 2e-3}
        return Gear(teeth=teeth, **(defaults | fields))

    return make
