"""Other flanks of a mesh in a scene that is assembled once: as in one assembled with them."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from transferred_scenes import SPEEDS, far_table, table, unit

from dynamics.assembly.assemble import assemble
from dynamics.errors import InputError
from dynamics.linearize import FlankTransfer, OtherFlanks, flank_transfer
from dynamics.meshes.technique import table_at

NEAR, FAR = (table_at(each, 0.0, 0.0) for each in (table(), far_table()))
ROLLING = pytest.mark.parametrize("rolling", [True, False])


@cache
def scene(rolling: bool) -> tuple[FlankTransfer, OtherFlanks]:
    system = assemble(unit(NEAR, NEAR, rolling))
    transfer = flank_transfer(system, SPEEDS, 3)
    return transfer, OtherFlanks.of(system, 0, transfer)


def assert_alike(found, expected, tolerance: float) -> None:
    for name in ("static", "force", "tangent", "viscous", "mean_force"):
        own, other = getattr(found, name), getattr(expected, name)
        np.testing.assert_allclose(own, other, rtol=0.0, atol=tolerance * np.abs(other).max(), err_msg=name)


@pytest.mark.law
@ROLLING
def test_other_flanks_excite_as_a_scene_assembled_with_them(rolling):
    """Damping by a ratio follows their stiffness, tangents of rolling bearings the equilibrium."""
    transfer, others = scene(rolling)
    whole = transfer.excitation(assemble(unit(FAR, NEAR, rolling)))
    found = others.with_table(FAR)
    assert_alike(found.excitation, whole, 1e-8)
    assert_alike(found.with_table(NEAR).excitation, others.excitation, 1e-8)


@pytest.mark.law
@ROLLING
def test_small_changes_of_inputs_are_those_of_the_flanks(rolling):
    transfer, others = scene(rolling)
    flanks = others.excitation
    beside = [replace(NEAR, deflection=NEAR.deflection + step) for step in (1e-10, 2e-10)]
    stiffer = replace(NEAR, stiffness=NEAR.stiffness * (1.0 + 1e-6))
    changes = others.changes([*beside, stiffer])
    inputs = transfer.inputs(flanks)
    moved = transfer.input_changes(flanks, inputs, changes)
    whole = transfer.inputs(others.with_table(stiffer).excitation) - inputs
    np.testing.assert_allclose(moved[..., 2], whole, rtol=0.0, atol=1e-4 * np.abs(whole).max())


@pytest.mark.law
def test_bearings_yield_to_changed_flanks_as_at_their_equilibrium():
    """A load that acts elsewhere on the face moves the tangents of rolling bearings."""
    transfer, others = scene(True)
    aside = replace(NEAR, load_arm=NEAR.load_arm + 1e-7)
    own, moved = others.excitation, others.with_table(aside).excitation
    (change,) = others.changes([aside])
    bearings = slice(transfer.first[2], None)
    expected = (moved.tangent - own.tangent)[bearings, bearings]
    np.testing.assert_allclose(
        change.tangent[bearings, bearings], expected, rtol=0.0, atol=1e-3 * np.abs(expected).max()
    )


def test_a_table_over_misalignments_is_refused():
    _, others = scene(False)
    wide = replace(NEAR, misalignment=np.array([0.0, 1e-5]))
    with pytest.raises(InputError, match="at one of them"):
        others.with_table(wide)
