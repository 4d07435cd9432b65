"""Laws of the compliance that a finite face width adds to plane strain."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from fe_contact import Gear, Material
from fe_contact.compliance import (
    FiniteWidthCompliance,
    PlaneHypothesis,
    finite_width_compliances,
    flank_compliance,
    flank_compliance_3d,
)
from fe_contact.compliance.finite_width import even_load, shape_functions, under_even_load
from fe_contact.contact.face_patch import FaceGrid, face_loads
from fe_contact.contact.patch import load_vector
from fe_contact.errors import InputError
from fe_contact.mesh import MeshRecipe, SectorRecipe


def beyond(gear: Gear, teeth: int = 3) -> FiniteWidthCompliance:
    """Of one gear, on the mesh made for it."""
    return finite_width_compliances([gear], [SectorRecipe.even_load(gear)], teeth)[0]


def uniform(s: np.ndarray) -> np.ndarray:
    """Nodal forces (k,) of a unit force spread over the upper half of a flank."""
    forces = np.zeros(s.size)
    length = np.where(s[:-2:2] > 0.5 * (s[0] + s[-1]), np.diff(s[::2]), 0.0)
    for node, share in ((slice(None, -2, 2), 1.0), (slice(1, None, 2), 4.0), (slice(2, None, 2), 1.0)):
        forces[node] += share * length / (6.0 * length.sum())
    return forces


def self_compliance(found: FiniteWidthCompliance) -> float:
    forces = uniform(found.s)
    return float(forces @ found.blocks[0] @ forces)


@pytest.fixture(scope="module")
def gear():
    return Gear(teeth=20, normal_module=4e-3, face_width=25e-3, bore_diameter=40e-3)


@pytest.fixture(scope="module")
def usual(gear):
    return beyond(gear)


@pytest.mark.law
@pytest.mark.usefixtures("exact_ring")
def test_half_a_face_stands_for_the_whole(gear):
    """Under even loads mid-face is a plane of symmetry."""
    half = replace(SectorRecipe.even_load(gear), layers=2, layer_growth=1.0)
    whole = replace(half, layers=4, half_face=False)
    first, second = (under_even_load(flank_compliance_3d(gear, recipe)) for recipe in (half, whole))
    assert np.abs(first - second).max() <= 1e-11 * np.abs(second).max()


def test_an_even_load_is_the_box_over_the_whole_face(gear):
    """Two integrations of the same patch, on uneven layers: nodal forces agree."""
    solid = flank_compliance_3d(gear, replace(SectorRecipe.even_load(gear), layers=2))
    center, width, share = 0.5 * (solid.s_form + solid.s_tip), 0.35 * gear.normal_module, 0.0
    profile = np.zeros(solid.s.size)
    load_vector(solid.s, center, width, share, profile)
    loads = face_loads(
        FaceGrid(solid.s, solid.z, solid.index),
        *(np.array([[x]]) for x in (center, width, share)),
        solid.z[:1],
        solid.z[-1:],
    )
    box = np.zeros(len(solid.blocks[0]))
    box[loads.nodes[0, : loads.used[0]]] = loads.forces[0, : loads.used[0]]
    assert even_load(solid.z, solid.index) @ profile == pytest.approx(box, abs=1e-12)


def test_it_vanishes_with_poissons_ratio_and_scales(gear, usual):
    none = beyond(replace(gear, material=Material(210e9, 0.0)))
    assert np.abs(none.blocks).max() <= 5e-4 * np.abs(usual.blocks).max()
    assert abs(self_compliance(none)) <= 1e-5 * self_compliance(usual)
    # Per unit width it has the dimension of 1/E; lengths leave it as it is.
    size, soft = 3.0, 0.5
    other = replace(
        gear,
        normal_module=size * gear.normal_module,
        face_width=size * gear.face_width,
        bore_diameter=size * gear.bore_diameter,
        material=Material(soft * 210e9, 0.3),
    )
    assert soft * self_compliance(beyond(other)) == pytest.approx(self_compliance(usual), rel=1e-6, abs=0.0)


def test_the_solid_gives_way_more_under_every_even_load():
    """The functions of plane strain are among those of the solid: all teeth of a small gear at once."""
    small = Gear(9, 4e-3, 12e-3, 10e-3, profile_shift_coefficient=0.5)
    found = beyond(small, teeth=5)
    whole = np.block([[found.block(i - j) for j in range(9)] for i in range(9)])
    values = np.linalg.eigvalsh(0.5 * (whole + whole.T))
    assert whole == pytest.approx(whole.T, rel=1e-9, abs=1e-9 * values[-1])
    assert values[0] >= -1e-9 * values[-1]


def test_a_thin_gear_is_in_plane_stress(gear):
    """Against the two-dimensional code: the difference of its hypotheses, own tooth and the next."""
    thin = beyond(replace(gear, face_width=0.1 * gear.normal_module))
    recipe = MeshRecipe.standard(gear).refined(0.25)
    strain, stress = (flank_compliance(gear, recipe, h) for h in PlaneHypothesis)
    forces = uniform(strain.s)
    coarse = shape_functions(thin.s, strain.s).T @ forces
    for tooth in (0, 1):
        difference = stress.block(tooth, 0) - strain.block(tooth, 0)
        expected = float(forces @ difference @ forces)
        assert float(coarse @ thin.block(tooth) @ coarse) == pytest.approx(expected, rel=0.02, abs=0.0)


def test_of_a_wide_gear_only_the_ends_count(gear):
    """Twice the width has the same ends, so half the mean; the more exactly, the wider."""
    wide = [self_compliance(beyond(replace(gear, face_width=w * gear.normal_module))) for w in (10, 20, 40)]
    first, second = (2.0 * b / a - 1.0 for a, b in pairwise(wide))
    assert abs(second) < 0.02
    assert abs(second) < 0.5 * abs(first)


def test_it_is_added_tooth_by_tooth(gear, usual):
    flat = flank_compliance(gear, MeshRecipe.standard(gear).refined(0.25), teeth=5)
    corrected = usual.added_to(flat)
    shape = shape_functions(usual.s, flat.s)
    for tooth, other in ((0, 0), (1, -1), (-1, 1)):
        added = corrected.block(tooth, other) - flat.block(tooth, other)
        assert added == pytest.approx(shape @ usual.block(tooth - other) @ shape.T, rel=1e-6, abs=1e-19)
    assert corrected.matrix == pytest.approx(corrected.matrix.T, rel=1e-9, abs=1e-19)


def test_shape_functions_reproduce_parabolas_and_a_helical_gear_is_refused(gear):
    nodes = np.array([0.0, 0.5, 1.0, 2.0, 3.0])
    at = np.array([-1.0, 0.0, 0.3, 1.7, 3.0])
    inside = np.maximum(at, 0.0)
    assert shape_functions(nodes, at) @ (nodes**2 - nodes) == pytest.approx(inside**2 - inside)
    with pytest.raises(InputError, match="helix_angle"):
        beyond(replace(gear, helix_angle=0.2))
