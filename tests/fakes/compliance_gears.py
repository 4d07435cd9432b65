"""Gears of few teeth, and sectors of them that are meshed coarsely."""

from __future__ import annotations

import math
from dataclasses import replace

from fe_contact.geometry import Gear, GearBlank, Toothing
from fe_contact.mesh import SectorRecipe

SPUR = Gear(teeth=9, normal_module=4e-3, face_width=20e-3, bore_diameter=12e-3, profile_shift_coefficient=0.4)
HELICAL = replace(SPUR, helix_angle=math.radians(25.0))
WEBBED = replace(HELICAL, blank=GearBlank(3e-3, 6e-3, 14e-3, web_offset=3e-3))


def coarse(gear: Toothing, **fields: object) -> SectorRecipe:
    m = gear.normal_module
    recipe = SectorRecipe(
        flank_size=0.5 * m,
        tip_size=0.3 * m,
        depth_size=0.6 * m,
        depth_limit=0.9 * m,
        body_size=0.5 * m,
        body_limit=1.5 * m,
        layers=4,
        land_elements=1,
        merge_rows=(-1,),
    )
    return replace(recipe, **fields)  # type: ignore[arg-type]
