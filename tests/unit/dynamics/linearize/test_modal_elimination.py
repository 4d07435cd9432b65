"""Modal freedoms eliminated from forced vibration: the response of the whole matrices, or none."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import gear_pair_scene, spring_table
from housed_pair import ON, housed_pair

from dynamics.assembly.assemble import assemble
from dynamics.linearize import harmonic_response, linearize, steady_vibration
from dynamics.linearize.steady_vibration import _modal_elimination


@pytest.mark.parametrize("gyroscopic", ["off", "on"])
def test_a_response_with_the_modes_eliminated_is_that_of_the_whole_matrices(monkeypatch, gyroscopic):
    table = spring_table(4e8, amplitude=1e-6)
    scene = housed_pair(effects=ON | {"gyroscopic": gyroscopic})
    system = assemble(replace(scene, meshes=gear_pair_scene(table).meshes))
    speeds = np.linspace(50.0, 400.0, 40)
    small = harmonic_response(system, speeds)
    eliminated = steady_vibration._modal_elimination
    seen = []
    monkeypatch.setattr(
        steady_vibration, "_modal_elimination", lambda *given: seen.append(eliminated(*given))
    )
    whole = harmonic_response(system, speeds)
    assert all(part is not None for part in seen) and seen
    for name in ("dynamic_transmission_error", "bearing_force", "displacement"):
        ours, theirs = getattr(small, name), getattr(whole, name)
        np.testing.assert_allclose(ours, theirs, rtol=0.0, atol=1e-11 * np.max(np.abs(theirs)), err_msg=name)
    assert small.residual < 1e-10


def test_gyroscopic_terms_turn_what_is_left():
    """Without them the same response is another one: they are not left out with the modes."""
    table, speeds = spring_table(4e8, amplitude=1e-6), np.linspace(50.0, 400.0, 10)
    answers = []
    for gyroscopic in ("off", "on"):
        scene = housed_pair(effects=ON | {"gyroscopic": gyroscopic})
        system = assemble(replace(scene, meshes=gear_pair_scene(table).meshes))
        answers.append(harmonic_response(system, speeds).displacement)
    without, turning = answers
    assert np.max(np.abs(turning - without)) > 1e-6 * np.max(np.abs(without))


def test_what_the_rows_of_elements_do_not_explain_is_not_eliminated():
    system = assemble(housed_pair())
    linear, modal = linearize(system), system.arrays.sparse.modal
    unit = np.ones(linear.scale.size)
    assert _modal_elimination(modal, unit, linear.stiffness, linear.damping, linear.mass) is not None
    coupled = linear.stiffness.copy()
    coupled[-1, -2] = coupled[-2, -1] = 1e-6 * np.max(np.abs(coupled))
    assert _modal_elimination(modal, unit, coupled, linear.damping, linear.mass) is None
    twice = modal._replace(shape=np.repeat(modal.shape[:1], len(modal.shape), axis=0))
    assert _modal_elimination(twice, unit, linear.stiffness, linear.damping, linear.mass) is None
