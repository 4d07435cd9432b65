"""Whether a compliance need not be computed: it is in the cache."""

from __future__ import annotations

from pathlib import Path

from fe_contact.compliance.cache import has_compliance
from fe_contact.compliance.cyclic_compliance import compliance_key_3d, usual_reach
from fe_contact.compliance.flank_compliance_2d import compliance_key, condensed_teeth
from fe_contact.compliance.plane import PlaneHypothesis
from fe_contact.compliance.solvers import SuperLuMetis
from fe_contact.geometry import Toothing
from fe_contact.mesh import MeshRecipe, SectorRecipe
from fe_contact.mesh.bore_support import PlaneStrain, bore_support


def is_kept(gear: Toothing, recipe: SectorRecipe, cache: Path | None) -> bool:
    """Whether the compliance over the face is kept."""
    if cache is None:
        return False
    support = bore_support(gear.right_handed())
    return has_compliance(cache, compliance_key_3d(gear, recipe, usual_reach(gear), support))


def free_ends_are_kept(gear: Toothing, recipe: SectorRecipe, teeth: int, cache: Path | None) -> bool:
    """Whether both solids are kept that correct the plane with `teeth` teeth for its finite width."""
    if cache is None:
        return False
    reach = min(teeth - 1, gear.teeth // 2)
    keys = (
        compliance_key_3d(gear, recipe, reach, support) for support in (bore_support(gear), PlaneStrain())
    )
    return all(has_compliance(cache, key) for key in keys)


def plane_is_kept(
    gear: Toothing, recipe: MeshRecipe, hypothesis: PlaneHypothesis, teeth: int, cache: Path | None
) -> bool:
    """Whether the compliance of `teeth` teeth in the plane is kept."""
    if cache is None:
        return False
    count = condensed_teeth(gear, recipe, teeth)
    return has_compliance(cache, compliance_key(gear, recipe, hypothesis, count, SuperLuMetis()))
