"""Gears and meshes to test with."""

from dataclasses import replace

import pytest

from fe_contact.geometry import Gear, RingGear
from fe_contact.mesh import MeshRecipe, mesh_gear

SIZE = {"normal_module": 4e-3, "face_width": 25e-3}
GEARS = {
    "all teeth, sectors down to the bore": (Gear(20, bore_diameter=40e-3, **SIZE), None),
    "all teeth above a hub": (Gear(40, bore_diameter=40e-3, **SIZE), None),
    "five teeth in a plain ring": (Gear(20, bore_diameter=40e-3, **SIZE), 5),
    "ring gear, sectors out to the rim": (RingGear(50, rim_diameter=240e-3, **SIZE), None),
    "ring gear below a thick rim": (RingGear(50, rim_diameter=320e-3, **SIZE), None),
    "five teeth in a plain ring gear": (RingGear(50, rim_diameter=240e-3, **SIZE), 5),
}


@pytest.fixture(scope="session", params=GEARS, ids=list(GEARS))
def gear_and_mesh(request):
    """Return a gear and its mesh, with each of the ways to close the ring, teeth outwards or inwards."""
    gear, real = GEARS[request.param]
    recipe = replace(MeshRecipe.standard(gear), flank_size=0.4e-3, real_teeth=real)
    return gear, mesh_gear(gear, recipe)
