"""Gears and meshes to test with."""

from __future__ import annotations

from dataclasses import replace

import pytest

from fe_contact.geometry import Gear
from fe_contact.mesh import GearMesh, MeshRecipe, mesh_gear

GEARS = {
    "all teeth, sectors down to the bore": (20, 40e-3, None),
    "all teeth above a hub": (40, 40e-3, None),
    "five teeth in a plain ring": (20, 40e-3, 5),
}


@pytest.fixture(scope="session", params=GEARS, ids=list(GEARS))
def gear_and_mesh(request: pytest.FixtureRequest) -> tuple[Gear, GearMesh]:
    """Return a gear and its mesh, with each of the three ways to close the ring."""
    teeth, bore, real = GEARS[request.param]
    gear = Gear(teeth=teeth, normal_module=4e-3, face_width=25e-3, bore_diameter=bore)
    recipe = replace(MeshRecipe.standard(gear), flank_size=0.4e-3, real_teeth=real)
    return gear, mesh_gear(gear, recipe)
