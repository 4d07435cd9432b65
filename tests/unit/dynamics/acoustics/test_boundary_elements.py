"""Boundary elements: spheres, sources inside a box, irregular frequencies, energy, reciprocity."""

import sys
from types import ModuleType

import numpy as np
import pytest
from hulls import box, sphere

from dynamics.acoustics import (
    Air,
    Hull,
    layer_operators,
    radiation_efficiency,
    resistance,
    sphere_efficiency,
    surface_pressure,
)
from dynamics.acoustics.boundary_elements import BoundaryElements
from dynamics.errors import InputError
from host import MissingExtra, Unavailable
from model_studies.workers import InProcess, dispatch, local_processes

AIR = Air()
MODEL = BoundaryElements()
WITH_LIBRARY = "boundary elements need the extra boundary-elements"
FINE = sphere(5)  # 500 panels; the axes are no axes of symmetry of its panels


def frequency(ka: float) -> float:
    return ka * AIR.sound_speed / (2.0 * np.pi)


@pytest.fixture(autouse=True, scope="module")
def _library():
    pytest.importorskip("ngsolve", reason=WITH_LIBRARY)


@pytest.mark.law
@pytest.mark.parametrize("ka", [0.1, 1.0, 1.83, np.pi])
def test_pulsating_and_oscillating_sphere_within_one_percent(ka):
    """At ka = pi the equation without its derivative has no unique solution."""
    shapes = np.stack([np.ones(len(FINE.areas)), FINE.normals @ [0.6, 0.0, 0.8]], axis=1)
    matrix = resistance(MODEL, FINE, frequency(ka), shapes, AIR)
    for order in (0, 1):
        plane = AIR.impedance * FINE.areas @ shapes[:, order] ** 2
        assert matrix[order, order].real / plane == pytest.approx(sphere_efficiency(order, ka), rel=0.01)
    assert abs(matrix[0, 1]) < 2e-3 * abs(matrix[0, 0])


def source_in(hull: Hull, at: np.ndarray, wavenumber: float) -> tuple[np.ndarray, float]:
    """Normal velocity on a hull from a monopole inside with p = e^{-ikr}/r, and its power, W."""
    away = hull.centers - at
    r = np.linalg.norm(away, axis=1)
    slope = -(1.0 / r + 1j * wavenumber) * np.exp(-1j * wavenumber * r) / r
    cosine = np.sum(away * hull.normals, axis=1) / r
    velocity = -slope * cosine / (1j * wavenumber * AIR.impedance)
    return velocity, 4.0 * np.pi / (2.0 * AIR.impedance)


@pytest.mark.law
@pytest.mark.parametrize("wavenumber", [2.0, 8.0])
def test_a_box_that_moves_as_the_air_around_a_source_radiates_its_power(wavenumber):
    """The field outside is the source's whatever the hull: closed form for a body with edges, to 1 %."""
    hull = box((0.4, 0.3, 0.25), (8, 6, 5))
    velocity, power = source_in(hull, np.array([0.05, -0.03, 0.02]), wavenumber)
    matrix = resistance(MODEL, hull, frequency(wavenumber), velocity[:, None], AIR)
    assert 0.5 * matrix[0, 0].real == pytest.approx(power, rel=0.01)


@pytest.mark.law
def test_the_pressure_on_the_box_is_that_of_the_source():
    hull, wavenumber, at = box((0.4, 0.3, 0.25), (8, 6, 5)), 4.0, np.array([0.05, -0.03, 0.02])
    velocity, _ = source_in(hull, at, wavenumber)
    solved = surface_pressure(hull, frequency(wavenumber), velocity[:, None], AIR)
    r = np.linalg.norm(hull.nodes - at, axis=1)
    exact = np.exp(-1j * wavenumber * r) / r
    assert np.linalg.norm(solved.pressure[:, 0] - exact) < 0.03 * np.linalg.norm(exact)


def test_errors_fall_with_the_square_of_the_edges():
    misses = [
        abs(radiation_efficiency(MODEL, hull, frequency(1.0), np.ones(len(hull.areas)), AIR) / 0.5 - 1.0)
        for hull in (sphere(2), sphere(4))
    ]
    assert 3.0 < misses[0] / misses[1] < 6.0


@pytest.mark.law
def test_power_into_the_air_arrives_far_away():
    """Energy balance: 1 % where the panels resolve the hull."""
    velocity, _ = source_in(FINE, np.array([0.3, 0.1, -0.2]), 2.0)
    solved = surface_pressure(FINE, frequency(2.0), velocity[:, None], AIR)
    assert abs(solved.imbalance(np.ones(1))) < 0.01
    assert solved.residual < 1e-8


def test_resistance_is_reciprocal_and_independent_of_place_and_turn():
    """The far field's matrix is symmetric for real shapes but for the panels."""
    hull = box((0.4, 0.3, 0.25), (5, 4, 3))
    shapes = np.stack([np.ones(len(hull.areas)), *hull.normals.T, hull.centers[:, 0] ** 2], axis=1)
    matrix = resistance(MODEL, hull, 300.0, shapes, AIR)
    assert np.abs(matrix.imag).max() < 5e-3 * np.abs(matrix).max()
    assert np.linalg.eigvalsh(matrix).min() > 0.0
    turn, _ = np.linalg.qr(np.random.default_rng(2).normal(size=(3, 3)))
    moved = Hull(hull.nodes @ (turn * np.linalg.det(turn)).T + [0.3, -2.0, 1.0], hull.triangles)
    np.testing.assert_allclose(
        resistance(MODEL, moved, 300.0, shapes, AIR), matrix, atol=1e-3 * np.abs(matrix).max()
    )


@pytest.mark.law
def test_operators_by_blocks_of_panels_are_the_whole_to_the_last_bit(monkeypatch):
    """Whoever assembles them: a pool has a library of its own, which sees a block at a time."""
    monkeypatch.setattr(dispatch, "START_SECONDS", 0.0)
    whole = layer_operators.layer_operators(FINE, 2.0)
    monkeypatch.setattr(layer_operators, "BLOCK", 170)
    with local_processes(2) as pool:
        for workers in (InProcess(), pool):
            for one, other in zip(
                layer_operators.layer_operators(FINE, 2.0, workers=workers), whole, strict=True
            ):
                np.testing.assert_array_equal(one, other)
        assert pool.cost.tasks == 3


def test_an_open_or_a_coarse_hull_is_refused():
    velocity = np.ones(len(FINE.areas))
    with pytest.raises(InputError, match="closed hull"):
        radiation_efficiency(MODEL, Hull(FINE.nodes, FINE.triangles[1:]), 50.0, velocity[1:], AIR)
    with pytest.raises(InputError, match=r"2\.6 edges in a wavelength"):
        radiation_efficiency(MODEL, FINE, 2000.0, velocity, AIR)


def test_without_the_library_its_extra_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "ngsolve", None)
    with pytest.raises(MissingExtra, match=r"lineofaction\[boundary-elements\]"):
        radiation_efficiency(MODEL, FINE, 50.0, np.ones(len(FINE.areas)), AIR)


def test_without_the_libraries_under_it_the_package_of_debian_is_named(monkeypatch):
    """A slim Debian lacks the one that its wheels leave to the system."""
    broken = ModuleType("ngsolve")  # without a part `bem`: an ImportError, as of a library that does not load
    monkeypatch.setitem(sys.modules, "ngsolve", broken)
    monkeypatch.setitem(sys.modules, "ngsolve.bem", ModuleType("ngsolve.bem"))
    with pytest.raises(Unavailable, match="apt-get install libquadmath0"):
        radiation_efficiency(MODEL, FINE, 50.0, np.ones(len(FINE.areas)), AIR)
