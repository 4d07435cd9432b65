"""Flexible shafts in small motion: an independent assembly, closed forms, limits."""

import math
from dataclasses import replace

import numpy as np
import pytest
from flexible_scenes import STEEL, bending_stiffness, flexible_pair, section_motion, shear_stiffness
from geared_scenes import gear_pair_scene, spring_table, with_gear
from scipy.linalg import eigh

from dynamics import Bushing, Coupling, FreeRotation, Inertia, Outputs, Shaft, TimeLaw
from dynamics.assembly.assemble import assemble
from dynamics.integrators import static_equilibrium
from dynamics.linearize import linearize, natural_modes, whirl_modes
from dynamics.linearize.whirl_modes import speed_terms
from dynamics.motion.force_balance import force_balance
from dynamics.shafts import BeamSection, DiscBody, timoshenko_beam


def dense(scene, mesh_stiffness, elements=40):
    """Mass and stiffness of both shafts in beam elements with gears, bearings, mesh and the held drive.

    Put together here from the beams alone: node by node, the drive's rotation taken out.
    """
    parts, grounds, size = [], [], 0
    for shaft in scene.shafts:
        gears = [gear for gear in scene.gears if gear.shaft == shaft.name]
        bushings = [bushing for bushing in scene.bushings if bushing.shaft == shaft.name]
        locations = [*(g.position for g in gears), *(b.position for b in bushings)]
        beam = timoshenko_beam(shaft.sections, locations, shaft.length / elements)
        parts.append((beam, size))
        grounds.append((gears, bushings))
        size += beam.mass.shape[0]
    mass, stiffness = np.zeros((size, size)), np.zeros((size, size))
    line, approach = assemble(scene).lines[0], np.zeros(size)
    for sign, shaft, (beam, first), (gears, bushings) in zip(
        (1.0, -1.0), scene.shafts, parts, grounds, strict=True
    ):
        own = slice(first, first + beam.mass.shape[0])
        mass[own, own] += beam.mass
        stiffness[own, own] += beam.stiffness
        for bushing in bushings:
            at = first + beam.freedoms(bushing.position)[:3]
            springs = (bushing.radial_stiffness, bushing.radial_stiffness, bushing.axial_stiffness)
            stiffness[at, at] += springs
        for gear in gears:
            at, i = first + beam.freedoms(gear.position), gear.inertia
            mass[at, at] += (i.mass, i.mass, i.mass, i.transverse, i.transverse, i.polar)
            center = np.add(shaft.origin, (0.0, 0.0, gear.position))
            approach[at] += sign * np.concatenate([line.force, np.cross(line.point - center, line.force)])
    stiffness += mesh_stiffness * np.outer(approach, approach)
    beam, first = parts[0]
    kept = np.delete(np.arange(size), first + beam.freedoms(scene.drives[0].position)[5])
    return mass[np.ix_(kept, kept)], stiffness[np.ix_(kept, kept)], approach[kept]


@pytest.mark.parametrize("helix", [0.0, 0.2])
def test_frequencies_are_those_of_an_independent_assembly(helix):
    """Up to the frequency of interest within twice the error estimated on the free shaft, and from above."""
    stepped = (BeamSection(0.07, 0.03), BeamSection(0.08, 0.05, 0.01), BeamSection(0.05, 0.025))
    scene = flexible_pair(gear=0.09, table=spring_table(4e8))
    scene = with_gear(with_gear(scene, 0, base_helix_angle=helix), 1, base_helix_angle=-helix)
    shafts = tuple(replace(shaft, sections=stepped) for shaft in scene.shafts)
    scene = replace(scene, shafts=shafts, outputs=Outputs(sample_rate=16e3))
    system = assemble(scene)
    mass, stiffness, _ = dense(scene, 4e8)
    if helix == 0.0:  # nothing moves along the axis then
        along = np.setdiff1d(np.arange(mass.shape[0]), along_axis(scene, mass.shape[0]))
        mass, stiffness = mass[np.ix_(along, along)], stiffness[np.ix_(along, along)]
    exact = np.sqrt(eigh(stiffness, mass, eigvals_only=True)) / (2.0 * math.pi)
    found = natural_modes(system).frequency
    count = int(np.searchsorted(exact, 8e3))
    assert count > 10
    error = found[:count] / exact[:count] - 1.0
    stated = max(r.elastic.truncation + r.elastic.mesh_error for r in system.rotors)
    assert np.max(np.abs(error)) < 2.0 * stated
    assert np.max(np.abs(error[:9])) < 1e-3
    assert np.min(error) > -2e-4  # the dense mesh is not the exact solution either


def along_axis(scene, size):
    """Indices of the freedoms along the axis in `dense`, whose held rotation is taken out."""
    beam = timoshenko_beam(scene.shafts[0].sections, [0.0, 0.09, 0.2], scene.shafts[0].length / 40)
    held = beam.freedoms(scene.drives[0].position)[5]
    locations = np.arange(2, size + 1, 6)
    return np.where(locations > held, locations - 1, locations)


def test_more_modes_bring_the_frequencies_down_to_those_of_the_whole_beam():
    """Craig-Bampton: from above, the closer the higher the frequency of interest; at rest nothing changes."""
    scene = flexible_pair(gear=0.06, table=spring_table(4e8))
    found, rest = [], []
    for rate in (2e3, 8e3, 32e3, 64e3):
        system = assemble(replace(scene, outputs=Outputs(sample_rate=rate)))
        found.append(natural_modes(system).frequency[:9])
        start = static_equilibrium(system)
        rest.append(section_motion(system, "output", 0.06, start.displacement))
    above = np.array(found[:-1]) / found[-1] - 1.0
    assert np.all(np.array(above) > -1e-4)
    worst = np.max(above, axis=1)
    assert worst[0] > worst[1] > worst[2]
    assert worst[0] > 3.0 * worst[2]
    np.testing.assert_allclose(rest[0], rest[3], rtol=1e-8, atol=1e-16)


def test_stiffer_shafts_tend_to_the_rigid_scene_in_proportion():
    """Ten times Young's modulus, a tenth of the difference of the natural frequencies."""
    rigid = assemble(flexible_pair(effects={"flexible_shafts": "off", "tilt": "on"}))
    expected = natural_modes(rigid).frequency
    errors = []
    for modulus in (1e14, 1e15, 1e16):
        system = assemble(flexible_pair(replace(STEEL, youngs_modulus=modulus)))
        found = natural_modes(system).frequency[: expected.size]
        errors.append(np.max(np.abs(found / expected - 1.0)))
    np.testing.assert_allclose(np.array(errors[:-1]) / errors[1:], 10.0, rtol=0.02)
    assert errors[0] < 5e-3


def beam_scene(section, stiffness, disc=None, location=0.0, bearings=(0.0, 0.5), spin=300.0, **changes):
    """A shaft on two bearings, turned through a soft coupling, with a disc on it or none."""
    effects = {"flexible_shafts": "on", "gyroscopic": "on", "tilt": "on", "lateral": "on"}
    scene = gear_pair_scene(spring_table(4e8), speed=TimeLaw.constant(spin), effects=effects)
    beam = Shaft("beam", section.length, (0.0, 0.0, 0.4), sections=(section,), damping_ratio=0.0)
    ends = tuple(
        Bushing(f"beam.{k}", "beam", z, stiffness, radial_damping=0.0) for k, z in enumerate(bearings)
    )
    joint = Coupling("joint", "input", "beam", 1e-3, position=0.4)
    return replace(
        scene,
        shafts=(*scene.shafts, beam),
        discs=() if disc is None else (DiscBody("disc", "beam", location, disc),),
        bushings=(*scene.bushings, *ends),
        couplings=(joint,),
        **changes,
    )


def of_the_beam(system, modes):
    """Circular frequencies of the modes in which the beam moves across its axis."""
    kinds = ("x", "y", "tilt_x", "tilt_y", "bending")
    own = [name.startswith(tuple(f"beam.{kind}" for kind in kinds)) for name in modes.freedom]
    size = np.abs(modes.shape * modes.scale)
    chosen = np.max(size[:, own], axis=1) > 0.5 * np.max(size, axis=1)
    return 2.0 * math.pi * modes.frequency[chosen]


def test_a_beam_on_stiff_bearings_has_the_frequencies_of_the_closed_form():
    """Timoshenko's beam, pinned at both ends: a quadratic in omega^2 for each k = n pi/L."""
    section = BeamSection(0.5, 0.04)
    bent, shear = bending_stiffness(section), shear_stiffness(section)
    mass, rotary = section.density * section.area, section.density * section.second_moment
    k = np.pi * np.arange(1, 5) / 0.5
    a, b, c = mass * rotary / shear, mass + rotary * k**2 + bent * mass * k**2 / shear, bent * k**4
    expected = np.sqrt((b - np.sqrt(b**2 - 4.0 * a * c)) / (2.0 * a))
    system = assemble(beam_scene(section, 1e13))
    found = np.unique(of_the_beam(system, natural_modes(system)).round(1))[:4]
    errors = found / expected - 1.0
    assert np.all(np.abs(errors) < system.rotors[2].elastic.mesh_error + 1e-4)
    euler = k**2 * np.sqrt(bent / mass)
    assert found[0] == pytest.approx(euler[0], rel=0.01)
    assert euler[3] > 1.08 * found[3]  # shear and rotary inertia show


def test_the_critical_speed_of_a_jeffcott_rotor():
    """sqrt(48 E I/(m L^3)) with the shear of the shaft in series, at any spin: the disc does not tilt."""
    section, disc = BeamSection(0.5, 0.03, density=1.0), Inertia(6.0, 0.03, 0.016)
    flexibility = 0.5**3 / (48.0 * bending_stiffness(section)) + 0.125 / shear_stiffness(section)
    critical = 1.0 / math.sqrt((flexibility + 0.5 / 1e10) * disc.mass)
    for spin in (10.0, critical):
        system = assemble(beam_scene(section, 1e10, disc, 0.25, spin=spin))
        found = of_the_beam(system, whirl_modes(system))
        assert np.sum(np.abs(found / critical - 1.0) < 1e-4) == 2  # forward and backward
    at_standstill = bending_stiffness(section) * 48.0 / 0.5**3 / disc.mass
    assert critical == pytest.approx(math.sqrt(at_standstill), rel=0.01)


def test_a_heavy_disc_sags_as_the_closed_form_says():
    """m g (L^3/(48 E I) + L/(4 kappa G A) + 1/(2 k)) at mid-length between two bearings."""
    section, disc = BeamSection(0.5, 0.03, density=1.0), Inertia(6.0, 0.03, 0.016)
    flexibility = 0.5**3 / (48.0 * bending_stiffness(section)) + 0.125 / shear_stiffness(section) + 0.5 / 1e8
    at = {}
    for g in (0.0, 9.81):
        system = assemble(beam_scene(section, 1e8, disc, 0.25, gravity=(0.0, -g, 0.0)))
        start = static_equilibrium(system)
        at[g] = section_motion(system, "beam", 0.25, start.displacement)
    sagged = at[9.81] - at[0.0]
    assert sagged[1] == pytest.approx(-disc.mass * 9.81 * flexibility, rel=1e-4)
    np.testing.assert_allclose(sagged[[0, 3, 5]], 0.0, atol=1e-6 * abs(sagged[1]))


def test_an_overhung_disc_whirls_as_its_flexibility_says():
    """M p'' - i w G p' + D^-1 p = 0 with the closed-form flexibilities D of the shaft's end."""
    section, disc = BeamSection(0.5, 0.03, density=1.0), Inertia(6.0, 0.08, 0.045)
    span, c, spin = 0.35, 0.15, 600.0
    bent, shear = bending_stiffness(section), shear_stiffness(section)
    by_force = c**2 * (span + c) / (3.0 * bent) + c * (1.0 + c / span) / shear
    cross = c * span / (3.0 * bent) + c**2 / (2.0 * bent) + c / (shear * span)
    by_moment = span / (3.0 * bent) + c / bent + 1.0 / (shear * span)
    on_bearings = np.array(
        [(1.0 + c / span) ** 2 + (c / span) ** 2, (1.0 + 2.0 * c / span) / span, 2.0 / span**2]
    )
    held = np.array([[by_force, cross], [cross, by_moment]]) + on_bearings[[[0, 1], [1, 2]]] / 1e10
    k = np.linalg.inv(held)
    mass, turn = np.diag([disc.mass, disc.transverse]), np.diag([0.0, disc.polar])
    state = np.block([[np.zeros((2, 2)), np.eye(2)], [-np.linalg.solve(mass, k), 0j * k]])
    state[2:, 2:] = np.linalg.solve(mass, 1j * spin * turn)
    expected = np.sort(np.abs(np.linalg.eigvals(state).imag))
    system = assemble(beam_scene(section, 1e10, disc, 0.5, (0.0, span), spin))
    found = np.sort(of_the_beam(system, whirl_modes(system)))[:4]
    np.testing.assert_allclose(found, expected, rtol=1e-4)
    assert expected[1] / expected[0] > 1.2


@pytest.mark.law
@pytest.mark.parametrize("torn", [False, True])
def test_time_integration_has_the_gyroscopic_terms_of_the_whirl_modes(torn):
    """All of them where torques alone turn the shaft, what shifts a frequency by 1e-4 where a drive does."""
    section, disc, spin = BeamSection(0.5, 0.05), Inertia(6.0, 0.08, 0.045), 1000.0
    scene = beam_scene(section, 1e9, disc, 0.2, spin=spin)
    if torn:
        scene = replace(scene, drives=(), free_rotations=(FreeRotation("train", "input", spin),))
    system = assemble(scene)
    q = static_equilibrium(system).displacement
    full, bare = (
        force_balance(system.arrays, 0.0, q, 0.0 * q, 0.0 * q, gyroscopic=on) for on in (True, False)
    )
    gyroscopic, _ = speed_terms(system, 0.0)
    unit = np.sqrt(np.diag(system.arrays.mass))
    missed, whole = ((full.damping - bare.damping - t) / np.outer(unit, unit) for t in (gyroscopic, 0.0))
    lowest = np.min(of_the_beam(system, natural_modes(system)))
    assert np.max(np.abs(missed)) < (1e-9 * np.max(np.abs(whole)) if torn else 2.5e-4 * lowest)
    assert np.max(np.abs(whole)) > 0.1 * lowest


def test_an_imposed_rotation_is_that_of_a_stiff_spring_at_its_position():
    """Torsion against the position of the drive, and free torsion held by a spring there, are one shaft."""
    scene = flexible_pair(gear=0.06, table=spring_table(4e8), highest_frequency=1e4)
    rigid = natural_modes(assemble(scene)).frequency
    drive = replace(scene.drives[0], stiffness=1e10)
    held = natural_modes(assemble(replace(scene, drives=(drive,)))).frequency
    np.testing.assert_allclose(held[:9], rigid[:9], rtol=2e-4)  # modes are cut off at other frequencies
    ratios = natural_modes(assemble(scene)).damping_ratio
    assert np.all(ratios > 0.0)


def test_modes_share_their_energy_with_the_shafts():
    linear = linearize(assemble(flexible_pair()))
    modes = natural_modes(linear)
    np.testing.assert_allclose(modes.strain_energy.sum(axis=1), 1.0, rtol=1e-6)
    assert any(name.startswith("input.bending") for name in linear.spring)
    np.testing.assert_allclose(modes.kinetic_energy.sum(axis=1), 1.0, rtol=1e-9)
