"""Deflection of an elastic ring: closed forms of thin and thick rings, equilibrium and reciprocity."""

import math

import numpy as np
import pytest
from rings import LUGS, RADIUS, annulus_elements, mesh_port, ring_of
from scipy.integrate import quad
from scipy.sparse import csr_matrix
from scipy.sparse.linalg import spsolve

from dynamics.elastic_ring.annulus import Annulus
from dynamics.elastic_ring.ring_compliance import HeldRing, Port
from dynamics.elastic_ring.ring_support import MAX_LUGS, RingSupport
from dynamics.errors import InputError


def softly_held(ring: Annulus, compliance: float) -> HeldRing:
    """Return a ring on lugs that hold it against motion as a rigid body and hardly deform it."""
    soft = 1e-7 / compliance
    return HeldRing(ring, RingSupport(lugs=4, first_lug=0.3, lug_radial=soft, lug_tangential=soft))


def equal_loads(ring: Annulus, count: int) -> float:
    """Return the outward displacement under one of equal outward loads on a free ring, m/N, by Castigliano.

    Between two loads the section at the angle f from the middle has the normal force N cos f, the shear force
    N sin f and the moment m + N R (1 - cos f), with N = 1 / (2 sin(pi / count)); m makes the energy least.
    """
    mean, half = ring.mean_radius, math.pi / count
    width, ratio = ring.width, math.log(ring.outer_radius / ring.inner_radius)
    lost = ring.height - mean * ratio
    section = np.linalg.inv(ring.youngs_modulus * width * np.array([[ratio, lost], [lost, -mean * lost]]))
    normal = 0.5 / math.sin(half)

    def energy(moment: float) -> float:
        def density(f: float) -> float:
            forces = np.array([normal * math.cos(f), moment + normal * mean * (1.0 - math.cos(f))])
            shear = normal * math.sin(f)
            return float(0.5 * forces @ section @ forces + 0.5 * shear**2 / ring.shear_rigidity)

        return quad(density, 0.0, half, epsabs=0.0, epsrel=1e-13)[0]

    unit = normal * mean
    least, high, low = energy(0.0), energy(unit), energy(-unit)
    curvature, slope = (high + low - 2.0 * least) / 2.0, (high - low) / 2.0
    least -= slope**2 / (4.0 * curvature)
    return 2.0 * 2.0 * least  # two halves of each part; the work of one load is half of load times way


def radial_port(ring: Annulus, count: int) -> Port:
    return Port(2.0 * np.pi * np.arange(count) / count, ring.mean_radius, 1.0, 0.0)


@pytest.mark.parametrize("slenderness", [0.02, 0.1, 0.3, 0.6])
@pytest.mark.parametrize("count", [2, 3, 5])
def test_equal_loads_deflect_a_free_ring_as_in_closed_form(count, slenderness):
    ring = ring_of(slenderness)
    closed = equal_loads(ring, count)
    out = softly_held(ring, closed).compliance(radial_port(ring, count)).sum(axis=1).mean()
    assert out == pytest.approx(closed, rel=1e-6)


def test_two_opposite_loads_on_a_thin_ring_are_those_of_the_textbook():
    ring = ring_of(0.01)
    inertia = ring.width * ring.height**3 / 12.0
    thin = RADIUS**3 / (ring.youngs_modulus * inertia) * (math.pi / 4.0 - 2.0 / math.pi)
    diameter = softly_held(ring, thin).compliance(radial_port(ring, 2)).sum()
    assert diameter == pytest.approx(thin, rel=3e-4)


def test_lugs_balance_forces_and_moment_of_the_meshes():
    ring = ring_of(0.12)
    mesh = mesh_port(ring, np.array([0.2, 1.9, 4.4]))
    radial, tangential = np.split(HeldRing(ring, LUGS).reactions(mesh), 2)
    turned = np.exp(1j * LUGS.angles)
    held = (turned[:, None] * (radial + 1j * tangential)).sum(axis=0)
    assert held == pytest.approx(-np.exp(1j * mesh.angle) * (mesh.radial + 1j * mesh.tangential), rel=1e-9)
    moment = ring.outer_radius * tangential.sum(axis=0)
    assert moment == pytest.approx(np.full(3, -mesh.radius * mesh.tangential), rel=1e-9)


def test_displacements_are_reciprocal_and_repeat_with_the_lugs():
    ring, angles = ring_of(0.2), np.array([0.2, 1.9, 4.4])
    held = HeldRing(ring, LUGS)
    compliance = held.compliance(mesh_port(ring, angles))
    assert compliance == pytest.approx(compliance.T, rel=1e-9)
    assert np.linalg.eigvalsh(compliance)[0] > 0.0
    turned = held.compliance(mesh_port(ring, angles + 2.0 * np.pi / LUGS.lugs))
    assert turned == pytest.approx(compliance, rel=1e-9)


def test_many_lugs_are_a_press_fit():
    ring, angles = ring_of(0.2), np.array([0.2, 1.9, 4.4])
    lugs = RingSupport(lugs=MAX_LUGS, lug_radial=2e6, lug_tangential=3e6)
    fit = RingSupport(fit_radial=MAX_LUGS * 2e6, fit_tangential=MAX_LUGS * 3e6)
    one, other = (HeldRing(ring, support).compliance(mesh_port(ring, angles)) for support in (lugs, fit))
    assert one == pytest.approx(other, rel=1e-6)


def test_uniform_expansion_is_that_of_a_thick_ring_on_its_fit():
    """Pressure of 100 loads: w / R = p R / (E J0 / R + k), with the integral J0 of 1 / r."""
    ring, fit = ring_of(0.3), RingSupport(fit_radial=4e9, fit_tangential=1e9)
    count = 100
    moved = HeldRing(ring, fit).compliance(radial_port(ring, count)).sum(axis=1)
    hoop = ring.youngs_modulus * ring.width * math.log(ring.outer_radius / ring.inner_radius)
    mean = count / (2.0 * np.pi) / (hoop + fit.fit_radial / (2.0 * np.pi))
    local = moved.mean() - mean  # a load sinks in beside the mean of all angles
    between = radial_port(ring, count).at(np.pi / count + radial_port(ring, count).angle)
    half = HeldRing(ring, fit).green(between, radial_port(ring, count)).sum(axis=1).mean() - mean
    assert 0.0 < local < 5e-3 * mean and -local < half < 0.0


@pytest.mark.parametrize("slenderness", [0.02, 0.1, 0.25])
def test_a_ring_a_thousand_times_smaller_is_as_many_times_softer(slenderness):
    """All lengths and all springs scaled by one factor; the unit of length decides nothing."""
    angles, factor = np.array([0.2, 1.9, 4.4]), 1e-3
    large = ring_of(slenderness)
    small = Annulus(factor * large.inner_radius, factor * large.outer_radius, factor * large.width)
    lugs = RingSupport(8, 0.1, factor * LUGS.lug_radial, factor * LUGS.lug_tangential)
    mesh = mesh_port(large, angles)
    scaled = Port(angles, factor * mesh.radius, mesh.radial, mesh.tangential)
    compliance = HeldRing(small, lugs).compliance(scaled)
    assert factor * compliance == pytest.approx(HeldRing(large, LUGS).compliance(mesh), rel=1e-7)


def test_harmonics_are_enough():
    for slenderness in (0.02, 0.1, 0.6):
        ring = ring_of(slenderness)
        assert HeldRing(ring, LUGS).remainder(mesh_port(ring, np.zeros(1))) < 1e-8


@pytest.mark.parametrize(
    "support",
    [
        RingSupport(),
        RingSupport(lugs=6, lug_radial=1e8),
        RingSupport(lugs=1, lug_tangential=1e8),
        RingSupport(fit_radial=1e9),
    ],
    ids=["nothing", "lugs let it rotate", "one lug", "a fit that slips"],
)
def test_a_support_that_leaves_the_ring_free_is_refused(support):
    with pytest.raises(InputError, match="holds the ring"):
        HeldRing(ring_of(0.1), support)


@pytest.mark.parametrize(
    ("kind", "name", "value"),
    [
        (RingSupport, "lugs", MAX_LUGS + 1),
        (RingSupport, "lugs", -1),
        (RingSupport, "lug_radial", -1.0),
        (RingSupport, "fit_tangential", math.inf),
        (Annulus, "outer_radius", 0.05),
        (Annulus, "width", math.nan),
    ],
)
def test_a_size_out_of_its_bound_is_named(kind, name, value):
    sizes = {"inner_radius": 0.1, "outer_radius": 0.12, "width": 0.02} if kind is Annulus else {}
    with pytest.raises(InputError) as caught:
        kind(**{**sizes, name: value})
    assert caught.value.field == name


def section_rows(ring, basis, angle, radial, tangential, radius):
    """Return the motion of a section in a direction at a radius, by the nodes of its corners, (n,)."""
    at = np.hypot(*basis.mesh.p)
    turned = np.angle(np.exp(1j * (np.arctan2(*basis.mesh.p[::-1]) - angle)))
    (nodes,) = np.nonzero(np.abs(turned) < 1e-6)
    y = at[nodes] - ring.mean_radius
    mean = np.full(y.size, 1.0 / y.size)
    slope = y / (y @ y)
    along = tangential * (mean + slope * (radius - ring.mean_radius))
    out = radial * mean
    row = np.zeros(basis.N)
    x, z = basis.nodal_dofs[:, nodes]
    row[x] = out * math.cos(angle) - along * math.sin(angle)
    row[z] = out * math.sin(angle) + along * math.cos(angle)
    return row


@pytest.mark.parametrize("slenderness", [0.08, 0.2])
def test_deflections_are_those_of_finite_elements(slenderness):
    """Loads and springs act on whole sections. What a load sinks in there is alike at all angles."""
    ring = ring_of(slenderness)
    lugs = RingSupport(lugs=8, lug_radial=2e8, lug_tangential=3e8)
    stiffness, _, basis = annulus_elements(ring)
    for angle in lugs.angles:
        for radial, tangential, spring in ((1.0, 0.0, lugs.lug_radial), (0.0, 1.0, lugs.lug_tangential)):
            row = csr_matrix(section_rows(ring, basis, angle, radial, tangential, ring.outer_radius))
            stiffness = stiffness + spring * row.T @ row
    angles = 2.0 * np.pi * np.array([3, 8, 12, 14, 77, 150]) / 200
    mesh = mesh_port(ring, angles)
    rows = [section_rows(ring, basis, angle, mesh.radial, mesh.tangential, mesh.radius) for angle in angles]
    matrix = np.array(rows)
    elements = matrix @ spsolve(stiffness.tocsc(), matrix.T)
    beam = HeldRing(ring, lugs).compliance(mesh)
    size = np.diag(elements).max()
    sunk = np.diag(elements) - np.diag(beam)
    others = elements - beam - np.diag(sunk)
    assert np.abs(others).max() < 5e-3 * size
    assert np.ptp(sunk) < 0.02 * size and 0.0 < sunk.mean() < 0.1 * size
