"""The finite elements of a tip corner yield as the wedge that the local law takes it for."""

import math
from dataclasses import replace

import numpy as np
import pytest

from fe_contact.compliance import flank_compliance
from fe_contact.contact.candidates import corner_softness
from fe_contact.contact.patch import load_vector
from fe_contact.geometry import Gear, RingGear
from fe_contact.mesh import MeshRecipe

GEARS = {
    "24 teeth": Gear(24, 2e-3, 20e-3, bore_diameter=24e-3),
    "ring of 72": RingGear(72, 2e-3, 20e-3, rim_diameter=164e-3, addendum_coefficient=0.85),
}


@pytest.mark.parametrize("name", GEARS)
def test_the_corner_at_a_tip_is_a_wedge(name, record_figure):
    """Self compliance of patches c at the edge: its slope in -ln(c) tends to k_w as c falls, evenly in c."""
    gear = GEARS[name]
    recipe = MeshRecipe.standard(gear)
    tip = replace(recipe, tip_size=0.05 * recipe.tip_size)
    flank = flank_compliance(gear, tip, teeth=1)
    lengths = gear.normal_module * np.array([0.004, 0.008, 0.016])
    half_plane = 2.0 / (math.pi * flank.contact_modulus)
    own = []
    for c in lengths:
        load = np.zeros(flank.s.size)
        first, last = load_vector(flank.s, flank.s[-1] - 0.5 * c, 0.5 * c, 1.0, load)
        load[:first], load[last:] = 0.0, 0.0
        own.append(load @ flank.block(0, 0) @ load / half_plane)
    near, far = -np.diff(own) / math.log(2.0)
    found, expected = 2.0 * near - far, corner_softness(gear)
    record_figure(f"tip corner over a half plane, {name}", found, f"{expected:.4f}", "", "wedge, closed form")
    assert found == pytest.approx(expected, rel=0.02, abs=0.0)
