"""The effect of flexible shafts: what calls for it, its influence, what cannot bend, refusals."""

from dataclasses import replace

import numpy as np
import pytest
from flexible_scenes import (
    STEEL,
    bending_stiffness,
    flexible_pair,
    section_motion,
    shear_stiffness,
    with_sections,
)
from geared_scenes import gear_pair_scene, with_mesh
from planetary_scenes import driven_scene, published_set

from dynamics import FreeRotation, Inertia, Outputs, Shaft
from dynamics.assembly.assemble import assemble
from dynamics.errors import InputError
from dynamics.integrators import static_equilibrium
from dynamics.shafts import BeamSection


def entry(scene, shaft="input"):
    entries = assemble(scene).ledger.entries
    return next(e for e in entries if (e.effect, e.part) == ("flexible_shafts", shaft))


def test_it_is_called_for_by_what_the_shaft_yields_at_the_mesh():
    scene = replace(flexible_pair(), effects={})
    found = entry(scene)
    assert found.on
    system = assemble(scene)
    start = static_equilibrium(system).displacement
    rigid = assemble(replace(scene, effects={"flexible_shafts": "off"}))
    off = entry(rigid.scene)
    assert not off.on
    assert off.influence == found.influence
    assert "off by request" in off.reason
    # the difference of both equilibria at the driver's mesh point, but for the mesh and the other shaft
    line, point = system.lines[0], 0.1
    before = static_equilibrium(rigid).displacement
    moved = section_motion(system, "input", point, start) - section_motion(rigid, "input", point, before)
    center = np.array([0.0, 0.0, point])
    wrench = np.concatenate([line.force, np.cross(line.point - center, line.force)])
    assert abs(wrench @ moved) == pytest.approx(found.influence, rel=1e-6, abs=0.0)
    thick = with_sections(gear_pair_scene(), replace(STEEL, youngs_modulus=1e14))
    assert not entry(thick).on


def test_its_influence_is_that_of_bending_where_torques_act_at_the_gears():
    """F (L^3/(48 E I) + L/(4 kappa A G)) on both shafts, and the wind-up of the wheel's where they do not."""
    scene = flexible_pair()
    at_gears = replace(
        scene,
        drives=(replace(scene.drives[0], position=0.1),),
        loads=(replace(scene.loads[0], position=0.1),),
    )
    force = assemble(scene).flanks.nominal_force[0]
    flexibility = 0.2**3 / (48.0 * bending_stiffness(STEEL)) + 0.05 / shear_stiffness(STEEL)
    for shaft in ("input", "output"):
        assert entry(at_gears, shaft).influence == pytest.approx(force * flexibility, rel=1e-9, abs=0.0)
        assert entry(scene, shaft).influence > 1.01 * force * flexibility


def test_off_nothing_changes():
    """Bit by bit the scene of rigid shafts with the inertia of the sections."""
    rigid = gear_pair_scene()
    off = with_sections(gear_pair_scene(effects={"flexible_shafts": "off"}))
    ours, theirs = assemble(off), assemble(rigid)
    assert ours.freedoms.name == theirs.freedoms.name
    matrices = ("mass", "damping", "stiffness", "direction", "position_gradient", "inertial", "total_inertia")
    for name in (*matrices, "scale"):
        np.testing.assert_array_equal(getattr(ours.arrays, name), getattr(theirs.arrays, name))
    np.testing.assert_array_equal(ours.bearing_stiffness, theirs.bearing_stiffness)


@pytest.mark.parametrize("case", ["no sections", "planetary set", "off the shaft", "bent table", "torn off"])
def test_what_cannot_bend_stays_rigid_and_says_why(case):
    effects = {"flexible_shafts": "on"}
    scene, shaft = flexible_pair(), "input"
    if case == "no sections":
        scene, words = gear_pair_scene(effects=effects), "no sections"
    elif case == "torn off":  # no bearings, no drive: one gear is all that acts
        scene, words = (
            replace(scene, bushings=(), outputs=Outputs(sample_rate=1e3)),
            "nothing bends or twists",
        )
        scene = replace(scene, drives=(), free_rotations=(FreeRotation("train", "input", 94.0),))
    elif case == "off the shaft":
        scene = replace(scene, drives=(replace(scene.drives[0], position=0.3),))
        words = '"drive" at 0.3 m is off the shaft'
    elif case == "bent table":
        scene, words = with_mesh(scene, bent_shafts=True), "has the bending of its shafts in it"
    else:
        scene, shaft, words = driven_scene(published_set(3)), "sun", "members of a planetary set"
        sun = scene.shafts[scene.shaft_index("sun")]
        own = replace(sun, inertia=Inertia(), sections=(BeamSection(sun.length, 0.05),))
        shafts = tuple(own if part.name == "sun" else part for part in scene.shafts)
        scene = replace(scene, shafts=shafts, effects={**scene.effects, **effects})
    found = entry(scene, shaft)
    assert words in found.reason
    assert not found.on
    assert not any(
        "bending" in name or "twist" in name for name in assemble(scene).freedoms.name if shaft in name
    )


def test_without_bearings_that_hold_it_a_shaft_twists_only():
    scene = replace(flexible_pair(), bushings=(), highest_frequency=1e4)
    names = assemble(scene).freedoms.name
    assert names == ("input.twist_1", "input.twist_2", "output.rotation", *names[3:])
    assert all(name.split(".")[1].startswith(("rotation", "twist")) for name in names)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"sections": (BeamSection(0.1, 0.04),)}, "as long as the shaft"),
        ({"inertia": Inertia(1.0, 1.0, 1.0)}, "left out where sections are given"),
    ],
)
def test_shafts_that_do_not_fit_their_sections_are_refused(changes, words):
    with pytest.raises(InputError, match=words):
        replace(Shaft("shaft", 0.2, sections=(STEEL,)), **changes)
