"""Laws that a three-dimensional flank compliance keeps on every mesh."""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from compliance_gears import HELICAL, SPUR, WEBBED, coarse, relative, whole_gear

import fe_contact.compliance.condensed_gear as gear_module
import fe_contact.compliance.cyclic_compliance as flow
import fe_contact.compliance.sector_stiffness as stiffness_module
from fe_contact import Material, RingGear
from fe_contact.compliance import ComplianceChecks, flank_compliance_3d, flank_compliances_3d
from fe_contact.compliance.condensed_gear import pressure_forces
from fe_contact.compliance.factorization import factorise
from fe_contact.compliance.flank import refuse_broken_laws
from fe_contact.compliance.gear_checks import least_eigenvalue
from fe_contact.compliance.sector_stiffness import twist
from fe_contact.errors import InputError, SolveError
from fe_contact.geometry import Toothing
from fe_contact.mesh import ClampedBore, SectorRecipe

GEARS = pytest.mark.parametrize("gear", [SPUR, HELICAL], ids=["spur", "helical"])
RING = RingGear(30, 4e-3, 20e-3, 150e-3, cutter_teeth=15, addendum_coefficient=0.6)
HELICAL_RING = replace(RING, rim_diameter=160e-3, helix_angle=math.radians(20.0))
BOTH_KINDS = pytest.mark.parametrize(
    "gear",
    [SPUR, HELICAL, RING, HELICAL_RING],
    ids=["spur", "helical", "ring", "helical ring"],
)


def global_compliance(gear: Toothing, recipe: SectorRecipe) -> np.ndarray:
    """Flank of every tooth under forces on tooth 0, (z, nf, nf), by one sparse factorisation of all teeth."""
    _, sector, number, matrix = whole_gear(gear, recipe)
    loads = np.zeros((matrix.shape[0], len(sector.flank)))
    loads[number[0, sector.flank], np.arange(len(sector.flank))] = 1.0
    return factorise(matrix, block=1)(loads)[number[:, sector.flank]]


@pytest.mark.drawn
@pytest.mark.law
@pytest.mark.parametrize(
    "gear",
    [SPUR, HELICAL, WEBBED, pytest.param(RING, marks=pytest.mark.nightly), HELICAL_RING],
    ids=["spur", "helical", "helical with a web", "ring", "helical ring"],
)
@pytest.mark.usefixtures("exact_ring")
def test_equals_the_solution_of_the_whole_gear(gear):
    found = flank_compliance_3d(gear, coarse(gear), reach=4)
    direct = global_compliance(gear, coarse(gear))
    for m in range(-4, 5):
        assert relative(found.block(m, 0), direct[m]) < 1e-9 * (1 + 9 * (m != 0))
    assert found.unknowns > 10_000


@BOTH_KINDS
def test_checks_hold_to_rounding(gear):
    found = flank_compliance_3d(gear, coarse(gear))
    assert found.checks.residual < 1e-11
    assert found.checks.reciprocity < 1e-13
    assert found.checks.bore_moment < 1e-11
    assert found.checks.energy < 1e-11
    assert np.array_equal(found.blocks[0], found.blocks[0].T)
    values = np.linalg.eigvalsh(found.blocks[0])
    assert values[0] > 0.0
    assert found.checks.least_eigenvalue == pytest.approx(values[0], rel=0.02)


def test_numbering_of_teeth_closes_the_ring():
    found = flank_compliance_3d(HELICAL, coarse(HELICAL), reach=4)
    assert np.array_equal(found.block(3, 1), found.blocks[2])
    assert np.array_equal(found.block(1, 3), found.blocks[2].T)
    assert np.array_equal(found.block(8, 0), found.blocks[1].T)
    assert np.array_equal(found.block(0, 8), found.blocks[1])
    near = replace(found, blocks=found.blocks[:2])
    with pytest.raises(KeyError):
        near.block(2, 0)
    # With an even number of teeth the one opposite is z / 2 steps either way: its block is symmetric.
    gear = replace(SPUR, teeth=8)
    found = flank_compliance_3d(gear, coarse(gear), reach=4)
    assert relative(found.blocks[4], found.blocks[4].T) < 1e-10
    assert relative(found.blocks[3], found.blocks[3].T) > 1e-3


@pytest.mark.law
def test_opposite_hands_are_mirror_images_to_the_last_bit():
    left = replace(HELICAL, helix_angle=-HELICAL.helix_angle)
    recipe = coarse(HELICAL)
    right, found = flank_compliance_3d(HELICAL, recipe), flank_compliance_3d(left, recipe)
    assert (right.base_helix_angle, found.base_helix_angle) == (
        HELICAL.base_helix_angle,
        left.base_helix_angle,
    )
    order = right.index[::-1][right.index[::-1] >= 0]
    for m in range(right.reach + 1):
        assert np.array_equal(found.blocks[m], right.blocks[m][np.ix_(order, order)])
    assert np.array_equal(found.z, -right.z[::-1])
    assert relative(found.blocks[1], right.blocks[1]) > 1e-3
    again = found.mirrored()
    assert np.array_equal(again.blocks, right.blocks)
    found = flank_compliance_3d(SPUR, coarse(SPUR))
    assert relative(found.mirrored().blocks, found.blocks) < 1e-10


@pytest.mark.parametrize("gear", [HELICAL, replace(RING, rim_diameter=160e-3, helix_angle=0.3)])
@pytest.mark.usefixtures("exact_ring")
def test_a_gear_swept_the_other_way_is_the_mirror_image(gear, monkeypatch):
    left = replace(gear, helix_angle=-gear.helix_angle)
    mirrored = flank_compliance_3d(left, coarse(gear), reach=2)
    signed = "twist", lambda gear: math.tan(gear.helix_angle) / gear.reference_radius
    monkeypatch.setattr(stiffness_module, *signed)
    swept = flow.compute_flank_compliance_3d(left, coarse(gear), 2, ClampedBore())
    assert relative(swept.blocks, mirrored.blocks) < 1e-10


def test_a_right_hand_tooth_leans_counter_clockwise():
    """Seen from +z a right-hand helix turns counter-clockwise on the way up (ISO 21771-1)."""
    assert twist(HELICAL) == pytest.approx(
        math.tan(HELICAL.helix_angle) / HELICAL.reference_radius, rel=1e-15
    )
    found = flank_compliance_3d(HELICAL, coarse(HELICAL), reach=1)
    # The upper end of a flank lies nearer to the lower end of the tooth ahead than the other way round.
    elements = (len(found.z) - 1, len(found.s) // 2)
    ends = []
    for layer in (0, -1):
        loaded = np.zeros(elements)
        loaded[layer] = 1.0
        ends.append(pressure_forces(found.s, found.z, found.index, loaded))
    low, high = ends
    assert low @ found.block(1, 0) @ high > 1.05 * (high @ found.block(1, 0) @ low) > 0.0


@pytest.mark.law
@GEARS
def test_compliance_goes_with_one_over_modulus_and_length(gear):
    found = flank_compliance_3d(gear, coarse(gear))
    large = replace(gear, normal_module=32e-3, face_width=160e-3, bore_diameter=96e-3)
    scaled = flank_compliance_3d(large, coarse(large))
    assert scaled.z == pytest.approx(8.0 * found.z, rel=1e-12)
    assert relative(8.0 * scaled.blocks, found.blocks) < 1e-9
    soft = replace(gear, material=Material(youngs_modulus=21e9))
    assert relative(0.1 * flank_compliance_3d(soft, coarse(gear)).blocks, found.blocks) < 1e-10


def test_reach_is_bounded_by_the_ring_and_alike_gears_computed_once():
    recipe = coarse(SPUR)
    twins = flank_compliances_3d(
        [SPUR, replace(SPUR, material=replace(SPUR.material, density=7000.0))], [recipe] * 2
    )
    assert twins[0] is twins[1]
    narrow, wide = flank_compliances_3d([SPUR, replace(SPUR, face_width=30e-3)], [recipe] * 2)
    uniform = [np.ones(len(c.blocks[0])) @ c.blocks[0] @ np.ones(len(c.blocks[0])) for c in (narrow, wide)]
    assert uniform[0] > 1.2 * uniform[1]
    for wrong in (-1, 5):
        with pytest.raises(InputError) as refusal:
            flank_compliance_3d(SPUR, coarse(SPUR), reach=wrong)
        assert refusal.value.field == "reach"
    assert flow.usual_reach(SPUR) == 2
    assert flow.usual_reach(RingGear(96, 4e-3, 20e-3, rim_diameter=0.424, addendum_coefficient=0.9)) == 2
    assert flow.usual_reach(replace(HELICAL, face_width=60e-3)) == 4
    assert flank_compliance_3d(SPUR, coarse(SPUR), reach=0).blocks.shape[0] == 1


@pytest.mark.parametrize("name", ["residual", "reciprocity", "bore_moment", "energy", "least_eigenvalue"])
def test_a_broken_law_is_refused_by_name(name):
    found = flank_compliance_3d(SPUR, coarse(SPUR, layers=2), reach=0)
    broken: ComplianceChecks = replace(found.checks, **{name: -1.0 if name == "least_eigenvalue" else 1e-3})
    with pytest.raises(SolveError, match=name.replace("_", ".")) as refusal:
        refuse_broken_laws(replace(found, checks=broken))
    assert refusal.value.partial is not None


def test_checks_see_a_wrong_ring(monkeypatch):
    """Each check is blind to none of: cuts that do not fit, blocks that do not belong."""
    genuine = gear_module.close_ring
    spoil: Callable[..., object]

    def spoiled(*arguments):
        return spoil(genuine(*arguments))

    monkeypatch.setattr(gear_module, "close_ring", spoiled)
    for law, change in {
        "residual": lambda ring: replace(ring, solved=np.roll(ring.solved, 1, axis=0)),
        "energy": lambda ring: replace(ring, blocks=ring.blocks * (1.0 + 1e-6)),
        "reciprocity": lambda ring: replace(ring, blocks=ring.blocks + 1e-3 * np.triu(ring.blocks, 1)),
    }.items():
        spoil = change
        with pytest.raises(SolveError) as refusal:
            flank_compliance_3d(HELICAL, coarse(HELICAL), reach=1)
        checks = refusal.value.partial.checks
        assert getattr(checks, law) > 1e-7, law


def test_least_eigenvalue_and_pressure_are_those_of_closed_forms():
    basis, _ = np.linalg.qr(np.random.default_rng(3).normal(size=(30, 30)))
    values = np.linspace(0.5, 4.0, 30)
    assert least_eigenvalue(basis * values @ basis.T) == pytest.approx(0.5, rel=0.02)
    values[3] = -1e-3
    assert least_eigenvalue(basis * values @ basis.T) < 0.0
    # Nodal forces of a pressure do its work on every quadratic field of s and z.
    s, z = np.array([0.0, 0.5, 1.0, 2.0, 3.0]), np.array([-1.0, 0.0, 2.0])
    planes = np.array([-1.0, -0.5, 0.0, 1.0, 2.0])
    index = np.full((5, 5), -1)
    exists = (np.arange(5)[:, None] % 2 == 0) | (np.arange(5) % 2 == 0)
    index[exists] = np.arange(exists.sum())
    loaded = np.array([[1.0, 0.0], [0.0, 2.0]])
    forces = pressure_forces(s, z, index, loaded)
    grid_s, grid_z = np.broadcast_arrays(s, planes[:, None])
    for p, q in ((0, 0), (1, 0), (0, 1), (1, 1), (2, 0), (0, 2)):

        def integral(low, high, power):
            return float((high ** (power + 1) - low ** (power + 1)) / (power + 1))

        exact = integral(0, 1, p) * integral(-1, 0, q) + 2.0 * integral(1, 3, p) * integral(0, 2, q)
        field = (grid_s**p * grid_z**q)[exists]
        assert forces @ field == pytest.approx(exact, abs=1e-14)
