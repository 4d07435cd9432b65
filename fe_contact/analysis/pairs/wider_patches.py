"""The error of load patches wider than the contact strips, because the mesh asks for it.

A patch spreads the load of a strip over more of the flank than it has, which shows where the gap changes
within it: at the knee of a relief above all. Coarse meshes do not tell, as they carry the same patches;
patches wider still do. Their error is of second order in the width.
"""

from __future__ import annotations

from fe_contact.geometry import ParallelAxes
from fe_contact.planning import Plan
from fe_contact.planning.plan import LARGEST_SUPPORT, wanted_patch

WIDER = 1.25
"""Width over that of the run at which the change is measured."""
SEEN = 0.7
"""Of what second order leaves over that change, the part that is counted: the strips are not as narrow as a
point. With it stated errors cover 95 % of the first harmonics of live answers (docs/accuracy.md)."""


def left_by_patches(pair: ParallelAxes, plan: Plan) -> float:
    """Return the error left over the change to patches `WIDER` times as wide.

    Against patches as wide as the strips of the largest load ask for; 0 where the run has those.
    """
    half_width = wanted_patch(pair, LARGEST_SUPPORT * float(plan.load[-1]))
    if plan.patch.half_width <= half_width:
        return 0.0
    return SEEN * (1.0 - (half_width / plan.patch.half_width) ** 2) / (WIDER**2 - 1.0)
