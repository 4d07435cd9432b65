"""From a gear to the unit-load stress of its tooth roots, in the plane or over the face, with its cache.

The mesh and the hypotheses are those of the flank compliances; only who asks for a stress pays for it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from fe_contact.compliance.cache import content_hash, read_compliance, write_compliance
from fe_contact.compliance.cyclic_compliance import SOLVER, compliance_key_3d, usual_reach
from fe_contact.compliance.flank_compliance_2d import compliance_key, condensed_teeth
from fe_contact.compliance.plane_elasticity import PlaneHypothesis
from fe_contact.compliance.root_stress import UnitRootStress
from fe_contact.compliance.solvers import Solver, SuperLuMetis
from fe_contact.geometry import Toothing
from fe_contact.geometry.gear import refuse_key
from fe_contact.mesh import MeshRecipe, SectorRecipe
from fe_contact.mesh.sector_grid import BoreSupport, bore_support

MODEL_VERSION = 1  # raise it whenever the same input gives another result: old cache files are then not found


def unit_root_stress(
    gear: Toothing,
    recipe: MeshRecipe | None = None,
    hypothesis: PlaneHypothesis = PlaneHypothesis.PLANE_STRAIN,
    *,
    teeth: int | None = None,
    solver: Solver | None = None,
    cache: Path | None = None,
) -> UnitRootStress:
    """Return the unit-load root stress of the transverse section; parameters are those of `flank_compliance`.

    Raises
    ------
    InputError
        `teeth` is even or exceeds the real teeth.
    MeshError
        No acceptable mesh.
    SolveError
        The matrix is singular, or the result breaks a law.
    """
    recipe, solver = recipe or MeshRecipe.standard(gear), solver or SuperLuMetis()
    count = condensed_teeth(gear, recipe, teeth)

    def compute() -> UnitRootStress:
        # A cached result needs no skfem.
        from fe_contact.compliance.root_stress_2d import compute_root_stress  # noqa: PLC0415

        return compute_root_stress(gear, recipe, hypothesis, count, solver)

    return _kept(compliance_key(gear, recipe, hypothesis, count, solver), compute, cache)


def unit_root_stress_3d(
    gear: Toothing,
    recipe: SectorRecipe | None = None,
    *,
    reach: int | None = None,
    support: BoreSupport | None = None,
    cache: Path | None = None,
) -> UnitRootStress:
    """Return the unit-load root stress over the face; parameters are those of `flank_compliance_3d`.

    Gears of opposite hand are mirror images to the last bit: the left-hand one is made from the other.

    Raises
    ------
    MeshError
        No acceptable mesh.
    SolveError
        The stiffness is singular, or the result breaks a law.
    """
    recipe, support = recipe or SectorRecipe.standard(gear), support or bore_support(gear.right_handed())
    distance = usual_reach(gear) if reach is None else reach
    refuse_key(gear, "root stress")

    def compute() -> UnitRootStress:
        # A cached result needs neither skfem nor numba.
        from fe_contact.compliance.root_stress_3d import compute_root_stress_3d  # noqa: PLC0415

        right_hand = gear.right_handed()
        return compute_root_stress_3d(right_hand, recipe, distance, support, SOLVER)

    stress = _kept(compliance_key_3d(gear, recipe, distance, support), compute, cache)
    return stress.mirrored() if gear.helix_angle < 0.0 else stress


def unit_root_stresses(
    gears: Sequence[Toothing],
    recipes: Sequence[MeshRecipe],
    hypothesis: PlaneHypothesis,
    *,
    teeth: int | None = None,
    cache: Path | None = None,
) -> tuple[UnitRootStress, ...]:
    """Return the root stress of each gear; gears of one section, material and recipe are computed once."""
    stresses: dict[str, UnitRootStress] = {}
    keys = []
    for gear, recipe in zip(gears, recipes, strict=True):
        count = condensed_teeth(gear, recipe, teeth)
        keys.append(compliance_key(gear, recipe, hypothesis, count, SuperLuMetis()))
        if keys[-1] not in stresses:
            stresses[keys[-1]] = unit_root_stress(gear, recipe, hypothesis, teeth=count, cache=cache)
    return tuple(stresses[key] for key in keys)


def unit_root_stresses_3d(
    gears: Sequence[Toothing], recipes: Sequence[SectorRecipe], *, cache: Path | None = None
) -> tuple[UnitRootStress, ...]:
    """Return the root stress of each gear; gears alike, or alike but for the hand, are computed once."""
    stresses: dict[str, UnitRootStress] = {}
    results = []
    for gear, recipe in zip(gears, recipes, strict=True):
        key = compliance_key_3d(gear, recipe, usual_reach(gear), bore_support(gear.right_handed()))
        if key not in stresses:
            right_hand = gear.right_handed()
            stresses[key] = unit_root_stress_3d(right_hand, recipe, cache=cache)
        results.append(stresses[key].mirrored() if gear.helix_angle < 0.0 else stresses[key])
    return tuple(results)


def _kept(compliance: str, compute: Callable[[], UnitRootStress], cache: Path | None) -> UnitRootStress:
    """Return the kept result that belongs to the `compliance` of a key, or compute and keep it."""
    key = content_hash({"root stress": MODEL_VERSION, "compliance": compliance})
    stress = read_compliance(cache, key, UnitRootStress) if cache is not None else None
    if stress is None:
        stress = compute()
        if cache is not None:
            write_compliance(cache, key, stress)
    return stress
