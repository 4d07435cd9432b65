"""Which flank of a gear in a file of REXS carries: by sense, datum face and role."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from rexs_loaded_flank import loaded
from rexs_stage import (
    PINION,
    STAGE,
    WHEEL,
    stage_unit,
)

from lineofaction.gearbox.from_rexs.meshing import LoadedFlank, Meshing

SIGNS = (1, -1)
DIRECTION = {1: "positive", -1: "negative"}


def side_by_vectors(sense: float, *, drives: bool, datum: int, ring: bool = False) -> str:
    """Return the loaded flank of a gear by where its tooth moves, seen from its datum face."""
    u, outwards = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])
    tip = -outwards if ring else outwards
    moves = sense * np.cross(u, outwards)
    right = np.cross(-datum * u, tip)  # of one who looks from the datum face, the tip upwards
    leading_is_right = bool(moves @ right > 0.0)
    return "right" if leading_is_right == drives else "left"


@pytest.mark.parametrize(("sense", "datum"), list(itertools.product(SIGNS, SIGNS)))
def test_a_driver_carries_on_its_leading_flank_a_driven_gear_on_its_trailing_one(
    sense: int, datum: int
) -> None:
    orientation = {"datum_face_orientation": DIRECTION[datum]}
    external = stage_unit({PINION: orientation, WHEEL: orientation})
    driver = side_by_vectors(sense, drives=True, datum=datum)
    driven = side_by_vectors(-sense, drives=False, datum=datum)
    assert loaded(external, PINION, 10.0 * sense).side == driver
    assert loaded(external, WHEEL, 10.0 * sense).side == driven


@pytest.mark.parametrize(("sense", "datum"), list(itertools.product(SIGNS, SIGNS)))
def test_a_ring_gear_carries_on_its_trailing_flank_its_tooth_turned_upwards(sense: int, datum: int) -> None:
    unit = stage_unit({WHEEL: {"datum_face_orientation": DIRECTION[datum]}}, {WHEEL: "ring_gear"})
    expected = side_by_vectors(sense, drives=False, datum=datum, ring=True)
    assert loaded(unit, WHEEL, 10.0 * sense).side == expected
    # If the ring gear drives, it carries on its leading flank, and the planet on its trailing one.
    meshing = Meshing.of(unit.part(STAGE), driver=WHEEL, torques=(10.0 * sense,))
    ring = LoadedFlank.of(meshing, unit.part(WHEEL))
    planet = LoadedFlank.of(meshing, unit.part(PINION))
    assert ring.side == side_by_vectors(sense, drives=True, datum=datum, ring=True)
    assert planet.side == side_by_vectors(sense, drives=False, datum=-1)


def test_a_gear_whose_axis_points_the_other_way_is_the_same_gear() -> None:
    turned = {"u_axis_vector": (-1.0, 0.0, 0.0), "datum_face_orientation": "negative"}
    straight = {"datum_face_orientation": "positive"}
    for torque in (10.0, -10.0):
        same = loaded(stage_unit({WHEEL: straight}), WHEEL, torque)
        assert loaded(stage_unit({WHEEL: turned}), WHEEL, torque).side == same.side


def test_the_chosen_torque_turns_the_pinion_so_that_right_flanks_carry() -> None:
    # Datum faces default to negative u: seen from there a pinion that turns about +u leads with its right.
    assert side_by_vectors(1, drives=True, datum=-1) == "right"
    assert loaded(stage_unit(), PINION, 10.0).side == "right"
