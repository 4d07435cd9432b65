"""Sizes of cached compliances: what is cached is not computed again, and takes as much memory."""

from __future__ import annotations

from pathlib import Path

from fe_contact.compliance.cache import cached_size
from fe_contact.compliance.cyclic_compliance import compliance_key_3d
from fe_contact.compliance.flank_compliance_2d import compliance_key, condensed_teeth
from fe_contact.compliance.plane_hypothesis import PlaneHypothesis
from fe_contact.compliance.tooth_reach import usual_reach
from fe_contact.geometry import Toothing
from fe_contact.mesh import MeshRecipe, SectorRecipe
from fe_contact.mesh.bore_support import PlaneStrain, bore_support


def solid_cached(gear: Toothing, recipe: SectorRecipe, cache: Path | None) -> int:
    """Return the bytes of the cached compliance over the face, 0 if it is not cached."""
    if cache is None:
        return 0
    support = bore_support(gear.right_handed())
    return cached_size(cache, compliance_key_3d(gear, recipe, usual_reach(gear), support))


def free_ends_cached(gear: Toothing, recipe: SectorRecipe, teeth: int, cache: Path | None) -> int:
    """Return the bytes of the cached solids by which a plane of `teeth` teeth is corrected for its free ends.

    0 if one of both solids is not cached.
    """
    if cache is None:
        return 0
    gear, reach = gear.whole, min(teeth - 1, gear.teeth // 2)
    keys = (
        compliance_key_3d(gear, recipe, reach, support) for support in (bore_support(gear), PlaneStrain())
    )
    sizes = [cached_size(cache, key) for key in keys]
    return sum(sizes) if all(sizes) else 0


def section_cached(
    gear: Toothing, recipe: MeshRecipe, hypothesis: PlaneHypothesis, teeth: int, cache: Path | None
) -> int:
    """Return the bytes of the cached compliance of `teeth` teeth in the plane, 0 if it is not cached."""
    if cache is None:
        return 0
    count = condensed_teeth(gear, recipe, teeth)
    return cached_size(cache, compliance_key(gear, recipe, hypothesis, count))
