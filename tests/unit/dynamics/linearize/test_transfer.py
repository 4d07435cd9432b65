"""Transfer functions of flanks: the response of other flanks, linearity, reciprocity, their file."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from transferred_scenes import SPEEDS, far_table, table, unit
from two_stage_scenes import two_stages

from dynamics.assembly.assemble import assemble
from dynamics.errors import InputError
from dynamics.linearize import forced_response, harmonic_response
from dynamics.linearize.steady_vibration import excited
from dynamics.linearize.transfer import FlankTransfer, flank_transfer, parting_share, transfer_seconds

ORDERS = 4


@cache
def transfer(rolling: bool = True) -> FlankTransfer:
    return flank_transfer(assemble(unit(rolling=rolling)), SPEEDS, ORDERS)


def assert_response(own: FlankTransfer, scene, tolerance: float) -> None:
    direct, system = harmonic_response(assemble(scene), SPEEDS, ORDERS), assemble(scene)
    moved = own.response(own.excitation(system))
    kept = np.isin(moved.order, direct.order)
    for name in ("bearing_force", "mesh_force"):
        expected = getattr(direct, name)
        found = getattr(moved, name)
        np.testing.assert_allclose(
            found[..., kept], expected, rtol=0.0, atol=tolerance * np.abs(expected).max()
        )
        assert np.all(np.abs(found[..., ~kept]) <= 1e-9 * np.abs(expected).max())
    np.testing.assert_allclose(moved.least_mesh_force, direct.least_mesh_force, rtol=1e-6)


@pytest.mark.parametrize("rolling", [True, False])
def test_the_flanks_of_the_scene_respond_as_it_does(rolling):
    assert_response(transfer(rolling), unit(rolling=rolling), 1e-9)


@pytest.mark.parametrize("rolling", [True, False])
def test_far_flanks_respond_as_a_scene_with_them(rolling):
    """Of one stage and of both; they move the equilibrium and so the tangents of rolling bearings."""
    for tables in ((far_table(), table()), (far_table(), far_table())):
        scene = unit(*tables, rolling=rolling)
        assert_response(transfer(rolling), scene, 1e-9)
    own = transfer(rolling)
    flanks = own.excitation(assemble(unit(far_table(), table(), rolling)))
    bearings = slice(own.first[2], None)
    unmoved = flanks.tangent.copy()
    unmoved[bearings, bearings] = own.tangent[bearings, bearings]
    force, apart = (own.response(each).bearing_force for each in (flanks, flanks._replace(tangent=unmoved)))
    assert bool(np.abs(apart - force).max() > 1e-3 * np.abs(force).max()) is rolling


def test_with_tangents_that_vary_flanks_respond_as_a_scene_with_them():
    """Of the scene itself and of far flanks; with the mean tangents alone forces are another."""
    own = transfer()
    for scene in (unit(), unit(far_table(), table())):
        system = assemble(scene)
        direct, at = forced_response(system, SPEEDS, ORDERS), excited(system, 0.0, ORDERS)
        inputs, residual = own.varied_inputs(at, own.excitation(system))
        assert residual < 1e-8
        kept = np.isin(own.order, direct.order)
        size = np.abs(direct.bearing_force).max()
        forces = [
            np.einsum("bdshc,shc->bdsh", own.bearing_force, each)[..., kept]
            for each in (inputs, own.inputs(own.excitation(system)))
        ]
        np.testing.assert_allclose(forces[0], direct.bearing_force, rtol=0.0, atol=1e-6 * size)
        assert np.abs(forces[1] - direct.bearing_force).max() > 1e-3 * size


def test_the_response_is_linear_in_what_excites():
    own = transfer()
    flanks = own.excitation(assemble(unit(far_table())))
    half = flanks._replace(force=0.5 * (flanks.force + own.force), tangent=own.tangent, viscous=own.viscous)
    whole = half._replace(force=flanks.force)
    nominal = own.bearing_force[..., 0]
    forces = [own.response(each).bearing_force - nominal for each in (half, whole)]
    np.testing.assert_allclose(2.0 * forces[0], forces[1], rtol=0.0, atol=1e-12 * np.abs(forces[1]).max())


@pytest.mark.law
def test_an_error_of_the_transmission_error_acts_as_it_does():
    """As an error of all of it adds the response of far flanks less that of flanks that excite nothing."""
    own = transfer()
    system = assemble(unit(far_table()))
    flanks = own.excitation(system)
    none = np.zeros(flanks.static.shape[1])
    errors = own.excitation_errors(system, flanks, 0, (flanks.static[0], none, none))
    np.testing.assert_allclose(errors[0].force[0], flanks.force[0], rtol=1e-9)
    assert not any(each.force.any() for each in errors[1:])
    assert not errors[0].force[own.first[1] :].any()
    silent = flanks._replace(force=flanks.force - errors[0].force)
    np.testing.assert_allclose(
        own.input_changes(flanks, own.inputs(flanks), errors)[..., 0],
        own.inputs(flanks) - own.inputs(silent),
        rtol=0.0,
        atol=1e-9 * np.abs(own.inputs(flanks)).max(),
    )


def test_a_stage_moves_the_other_as_that_one_moves_it():
    """Reciprocity of the receptances, where the tangents of the flanks are symmetric."""
    receptance = flank_transfer(assemble(two_stages()), SPEEDS, 1).motion[..., 1:]
    crossed = np.swapaxes(receptance, 0, 3)
    assert np.abs(receptance[0, ..., 1]).max() > 1e-4 * np.abs(receptance).max()
    np.testing.assert_allclose(receptance, crossed, rtol=0.0, atol=1e-9 * np.abs(receptance).max())


def test_they_are_kept_by_their_content(tmp_path, monkeypatch):
    scene = two_stages(table())
    first = flank_transfer(assemble(scene), SPEEDS, 1, cache=tmp_path)
    monkeypatch.setattr("dynamics.linearize.transfer._computed_transfer", lambda *_: pytest.fail("computed"))
    kept = flank_transfer(assemble(scene), SPEEDS, 1, cache=tmp_path)
    assert np.array_equal(kept.motion, first.motion)
    assert np.array_equal(kept.bearing_force, first.bearing_force)
    monkeypatch.undo()
    stiffer = replace(scene, bushings=tuple(replace(b, radial_stiffness=3e8) for b in scene.bushings))
    for other, orders in ((stiffer, 1), (scene, 2)):
        flank_transfer(assemble(other), SPEEDS, orders, cache=tmp_path)
    assert len(list(tmp_path.iterdir())) == 3


def test_another_scene_is_refused():
    with pytest.raises(InputError, match="the scene of the transfer"):
        transfer().excitation(assemble(two_stages(table())))


@pytest.mark.law
def test_what_is_predicted_goes_with_the_lines_that_are_solved():
    """Of two stages whose pitches share a long period, over all speeds."""
    system, counts, seconds = assemble(unit()), [], []
    for orders, speeds in ((1, SPEEDS[:1]), (ORDERS, SPEEDS)):
        counts.append(flank_transfer(system, speeds, orders).motion[0, ..., 0].size)
        seconds.append(transfer_seconds(system, speeds, orders))
    assert counts[1] > 4 * counts[0]
    assert seconds[1] / seconds[0] == pytest.approx(counts[1] / counts[0])


@pytest.mark.parametrize(
    ("least", "mean", "share"),
    [
        ((30.0, 5.0), (100.0, -100.0), 0.0),
        ((-30.0, 5.0), (100.0, -100.0), 0.3),
        ((-1.0, 0.0), (0.0, 0.0), 1.0),
        ((0.0, 0.0), (0.0, 50.0), 0.0),
        ((), (), 0.0),
    ],
)
def test_flanks_part_by_a_share_of_the_static_force_and_wholly_where_none_presses_them(least, mean, share):
    assert parting_share(np.array(least), np.array(mean)) == pytest.approx(share)
