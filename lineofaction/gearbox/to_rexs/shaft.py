"""Results of a shaft: its deflection line."""

from __future__ import annotations

import numpy as np

from bounds.types import FloatArray
from lineofaction.gearbox.from_rexs.scene_parts import ShaftPart
from lineofaction.gearbox.rexs.model import Attribute
from lineofaction.gearbox.to_rexs.attributes import calculated
from lineofaction.gearbox.units import MM, UM


def shaft_results(part: ShaftPart, position: FloatArray, motion: FloatArray) -> tuple[Attribute, ...]:
    """Return the deflection line of a shaft along its own u, v, w, by increasing u, mean over the mesh cycle.

    `position` (P,) is from the left end in the scene, m, increasing; `motion` (P, 6) displacement in x, y, z,
    m, and rotation about them, rad.
    """
    order = slice(None, None, part.sense)
    u = part.sense * (position - part.zero)[order]
    displacement = (motion[:, :3] @ part.rotation)[order]
    torsion = part.sense * motion[order, 5]
    return (
        calculated("u_coordinates_of_beam_nodes", (u / MM).tolist(), "mm"),
        *(
            calculated(f"displacement_{axis}_of_nodes", (displacement[:, k] / UM).tolist(), "mum")
            for k, axis in enumerate("uvw")
        ),
        calculated("torsion_u", np.degrees(torsion).tolist(), "deg"),
    )
