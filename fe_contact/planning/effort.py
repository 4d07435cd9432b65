"""Work of a run in seconds of one certain host: what alternatives are weighed by.

The choice of a mesh must not depend on the host, nor on what is in the cache, nor on earlier runs: the same
case has the same table everywhere. So this knows none of them. It is also quick, since several alternatives
are weighed before a run: finite elements over the face are a fit, within a factor 1.8, to the operations that
`fe_contact.compliance.cyclic_compliance` counts, of gears of 18 to 60 teeth and faces of 4 to 14 modules.
"""

from __future__ import annotations

from fe_contact.contact import ContactModel
from fe_contact.geometry import ParallelAxes
from fe_contact.mesh import SectorRecipe
from fe_contact.planning.cost_model import contact_seconds, section_cost
from fe_contact.planning.discretization import FaceDiscretization
from fe_contact.planning.plan import Plan

# one gear over the face: mesher, factor, powers of layers and teeth, part of it for the coarse mesh
_MESHER = 0.15
_SOLID = {
    "draft": (9.3e-5, 2.28, 1.11, 0.34),
    "standard": (1.05e-4, 2.58, 0.89, 0.25),
    "fine": (7.3e-4, 2.35, 0.81, 0.19),
}
_FREE_ENDS = 0.35
"""The solids that correct one gear for its finite width."""


def effort(pair: ParallelAxes, plan: Plan, model: ContactModel, alignments: tuple[int, int]) -> float:
    """Return the work of a run with nothing in the cache, CPU seconds of the host of the constants.

    Parameters are those of `fe_contact.planning.predict_run`.
    """
    made = plan.discretization
    bodies = tuple(body.right_handed() for body in plan.bodies(pair))
    work = sum(contact_seconds(pair, plan, model, alignments))
    if isinstance(made, FaceDiscretization):
        gears = dict.fromkeys(zip(bodies, made.recipes, strict=True))
        return work + sum(_solid(gear.teeth, recipe, plan.level) for gear, recipe in gears)
    for recipes in (made.recipes, made.coarse_recipes):
        sections = dict.fromkeys(zip(bodies, recipes, strict=True))
        work += sum(section_cost(gear, recipe)[0] for gear, recipe in sections)
    return work + (_FREE_ENDS * len(dict.fromkeys(bodies)) if made.corrected else 0.0)


def _solid(teeth: int, recipe: SectorRecipe, level: str) -> float:
    """One gear over the face, on its own mesh and on the coarse one."""
    factor, layers, number, coarse = _SOLID[level]
    seconds = float(factor * recipe.layers**layers * teeth**number)
    return 2.0 * _MESHER + (1.0 + coarse) * seconds
