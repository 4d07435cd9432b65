"""Root stress under refinement, its stated error, and the middle of a wide gear against plane strain."""

import functools
from dataclasses import replace

import numpy as np
import pytest
from analysis_requests import point_request
from spur_gears import GEAR

from fe_contact import GearPair, root_stress
from fe_contact.analysis.flanks.root_meshes import finer_root
from fe_contact.analysis.flanks.root_stress import LOAD_SHARING
from fe_contact.analysis.flanks.root_stress_history import crest_values
from fe_contact.compliance import UnitRootStress, unit_root_stress, unit_root_stress_3d
from fe_contact.contact.face_patch import FaceGrid, face_loads
from fe_contact.contact.patch import load_vector
from fe_contact.mesh import MeshRecipe, PlaneStrain, SectorRecipe

PEAKS = ("tension", "compression")


def peaks(found: UnitRootStress, width: float = 1.0) -> np.ndarray:
    """Extreme profile stresses (2,) at the middle of the face, per line load high on the flank."""
    center, half = np.array([[0.7 * found.s[-1]]]), np.array([[0.3 * GEAR.normal_module]])
    forces = np.zeros(found.stress.shape[-1])
    if found.across_face:
        grid = FaceGrid(found.s, found.z, found.index)
        loads = face_loads(grid, center, half, np.zeros((1, 1)), found.z[:1], found.z[-1:])
        forces[loads.nodes[0, : loads.used[0]]] = width * loads.forces[0, : loads.used[0]]
    else:
        load_vector(found.s, center[0, 0], half[0, 0], 0.0, forces)
    own = found.stress[len(found.distance) // 2, :, 0] @ forces * np.array([1.0, -1.0])[:, None, None]
    middle = np.argmin(np.abs(found.station_z))
    return crest_values(found.station_s, own[..., middle])[0]


@functools.cache
def refined(factor: float) -> np.ndarray:
    return peaks(unit_root_stress(GEAR, MeshRecipe.standard(GEAR).refined(factor), teeth=1))


@pytest.mark.law
def test_the_plane_converges(record_figure):
    errors = {f: refined(f) / refined(2.0) - 1.0 for f in (0.5, 1.0)}
    for i, name in enumerate(PEAKS):
        # the crest between stations scatters by a few 1e-4 with where the elements lie
        assert abs(errors[0.5][i]) < 3e-3
        assert abs(errors[1.0][i]) < 1.2e-3
        record_figure(
            f"root stress in the plane, {name}: standard mesh over one twice as fine",
            100.0 * errors[1.0][i], "within 0.12", "%", "refinement",
        )  # fmt: skip


@pytest.mark.parametrize(("level", "limits"), [("standard", (0.005, 0.01)), ("fine", (0.006, 0.006))])
def test_sectors_converge_to_the_plane(level, limits, record_figure):
    """One layer, no axial displacement: the section alone, finer at the root than the contact's."""
    recipe = finer_root(getattr(SectorRecipe, level)(GEAR))
    one = replace(recipe, layers=1, merge_rows=(), layer_growth=1.0)
    found = peaks(unit_root_stress_3d(GEAR, one, reach=0, support=PlaneStrain()), GEAR.face_width)
    errors = found / refined(2.0) - 1.0
    for error, limit, name in zip(errors, limits, PEAKS, strict=True):
        assert abs(error) < limit
        record_figure(
            f"root stress over the face, {name}: {level} section over a fine plane mesh",
            100.0 * error, f"within {100.0 * limit:.2g}", "%", "refinement",
        )  # fmt: skip


def test_a_finer_root_is_worth_it():
    """The contact's own section errs by one and more per cent at the root."""
    recipe = replace(SectorRecipe.standard(GEAR), layers=1, merge_rows=(), layer_growth=1.0)
    plain, finer = (
        np.abs(
            peaks(unit_root_stress_3d(GEAR, r, reach=0, support=PlaneStrain()), GEAR.face_width)
            / refined(2.0)
            - 1.0
        )
        for r in (recipe, finer_root(recipe))
    )
    assert np.all(finer < 0.5 * plain)


@pytest.mark.law
def test_the_middle_of_a_wide_gear_approaches_plane_strain(record_figure):
    recipe = replace(
        SectorRecipe.draft(GEAR), merge_rows=(), layer_growth=1.0, body_limit=3.0 * GEAR.normal_module
    )
    flat = peaks(
        unit_root_stress_3d(GEAR, replace(recipe, layers=1), reach=0, support=PlaneStrain()), GEAR.face_width
    )
    excess = []
    for width, layers in ((5.0, 4), (20.0, 8), (60.0, 12)):
        gear = replace(GEAR, face_width=width * GEAR.normal_module)
        found = peaks(unit_root_stress_3d(gear, replace(recipe, layers=layers), reach=0), gear.face_width)
        excess.append(found / flat - 1.0)
    assert np.all(excess[0] > 0.03)  # end faces are free to move along the axis
    assert np.all(np.abs(excess[1]) < 0.005)
    assert np.all(np.abs(excess[2]) < 5e-4)
    name = "root stress of a gear 60 modules wide over plane strain, mid-face"
    record_figure(name, 100.0 * float(excess[2][0]), "within 0.05", "%", "limit of a wide gear")


@pytest.mark.law
def test_the_stated_error_holds_in_the_plane():
    pair = GearPair(GEAR, GEAR, 80e-3)
    found = {
        level: root_stress(pair, *point_request(torque=100.0, level=level), at=[0.0, 0.19]).pinion
        for level in ("draft", "standard", "fine")
    }
    for root in PEAKS:
        fine = found["fine"].peak(root).stress
        for level in ("draft", "standard"):
            rough = found[level].peak(root).stress
            assert abs(rough.value - fine.value) < rough.error + fine.error
            assert rough.error < (LOAD_SHARING + 0.02) * abs(rough.value)
