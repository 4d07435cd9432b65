"""Runs of rotors on rolling bearings: paths, energy balance, loads at rest."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import gear_pair_scene
from rotors_on_bearings import (
    KINDS,
    ON,
    PRELOAD,
    SEATS,
    pair_of,
    rotor,
)

from dynamics.assembly.assemble import assemble
from dynamics.bearings import RollingBearing
from dynamics.integrators import integrate, static_equilibrium
from dynamics.scene import Integration
from dynamics.simulation import simulate


@pytest.mark.parametrize("kind", ["deep groove", "cylindrical"])
def test_a_run_says_what_its_bearings_carry_at_rest(kind):
    """Stribeck: under no clearance the heaviest of n elements carries about 4.37 or 4.08 W/n."""
    straight = {"profile": "straight"} if kind == "cylindrical" else {}
    row, weight = replace(KINDS[kind], clearance=0.0, **straight), 40.0 * 9.81
    scene = rotor((row, row), gravity=(0.0, -9.81, 0.0), duration=0.001)
    found = simulate(scene).receipt["rolling_bearings"]
    stribeck = {"deep groove": 4.37, "cylindrical": 4.08}[kind]
    for name in ("seat 0", "seat 1"):
        at = found[name]
        np.testing.assert_allclose(at["force"][:3], [0.0, -weight / 2.0, 0.0], atol=1e-5 * weight)
        assert at["element_load"] == pytest.approx(stribeck * weight / 2.0 / row.count, rel=0.02)
        assert at["displacement"][1] < 0.0
        if kind == "deep groove":
            inner = row.contacts()[0].peak_pressure(at["element_load"])
            assert at["peak_pressure"] == pytest.approx(inner, rel=1e-12)


def thrown(method, kind, tolerance=1e-11):
    """A rotor at rest thrown upwards and tilting: its path, and the run."""
    preload = 0.0 if kind in SEATS else PRELOAD
    scene = rotor(pair_of(KINDS[kind]), preload, gravity=(0.0, -9.81, 3.0), duration=0.01, kind=kind)
    system = assemble(scene)
    start = static_equilibrium(system)
    velocity = np.zeros(start.displacement.size)
    for freedom, rate in (("y", 0.02), ("z", 0.005), ("tilt_x", 0.05)):
        velocity[system.freedoms.name.index(f"rotor.{freedom}")] = rate
    run = integrate(system, start, Integration(method=method, tolerance=tolerance), velocity=velocity)
    assert run.status.usable
    return np.array([q for q, name in zip(run.q.T, system.freedoms.name, strict=True) if "rotor." in name])


@pytest.mark.parametrize("kind", ["angular", "tapered", "floating", "cross-located"])
def test_both_integrators_take_the_same_path(kind):
    explicit, implicit = (thrown(method, kind) for method in ("explicit", "implicit"))
    largest = np.max(np.abs(explicit[:3]))
    for path, other, scale in zip(explicit, implicit, (1.0, 1.0, 1.0, 0.1, 0.1, 0.1), strict=True):
        np.testing.assert_allclose(scale * other, scale * path, atol=1e-4 * largest)
    assert np.max(np.abs(explicit[1])) > 1e-6


@pytest.mark.parametrize("kind", ["angular", "floating", "cross-located"])
def test_a_run_closes_its_energy_balance(kind):
    scene = gear_pair_scene(effects=ON, duration=0.02)
    seats = SEATS.get(kind, ("both", "both"))
    bearings = tuple(
        RollingBearing(
            bushing.name,
            bushing.shaft,
            row,
            bushing.position,
            np.sign(row.contact_angle) * 200.0,
            locating=seat,
        )
        for bushing, row, seat in zip(scene.bushings, 2 * pair_of(KINDS[kind]), 2 * seats, strict=True)
    )
    scene = replace(scene, bushings=(), rolling_bearings=bearings, integration=Integration(tolerance=1e-10))
    result = simulate(scene)
    assert result.status.usable
    assert result.energy.relative < 1e-3
    assert result.energy.bushings > 0.0
