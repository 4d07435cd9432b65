"""A free-form flank: its interpolant, its place in the modification, and what it refuses."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict
from typing import Any

import numpy as np
import pytest

from fe_contact.errors import InputError
from fe_contact.geometry import FlankGrid, FlankModification, Gear

ROLL = (4e-3, 7e-3, 9e-3, 14e-3, 19e-3)
FACE = (-12.5e-3, -9e-3, -2e-3, 4e-3, 12.5e-3)
NODES = FlankGrid(ROLL, FACE, 1e-6 * np.random.default_rng(7).uniform(-5.0, 20.0, (5, 5)))


def sampled(function: Callable[[np.ndarray, np.ndarray], np.ndarray]) -> FlankGrid:
    """Return the grid of a function of roll length and face position."""
    return FlankGrid(ROLL, FACE, function(np.array(ROLL)[:, None], np.array(FACE)) + np.zeros((5, 5)))


def inside(count: int = 41) -> tuple[np.ndarray, np.ndarray]:
    roll, face = np.linspace(ROLL[0], ROLL[-1], count), np.linspace(FACE[0], FACE[-1], count)
    return tuple(np.meshgrid(roll, face, indexing="ij"))


def test_nodes_are_met_and_end_values_hold_beyond_them() -> None:
    roll, face = np.meshgrid(ROLL, FACE, indexing="ij")
    assert NODES.material_removed(roll, face) == pytest.approx(np.array(NODES.removed), rel=1e-12, abs=1e-20)
    beyond = NODES.material_removed(np.array([0.0, 1.0]), np.array([-1.0, 4e-3]))
    assert beyond == pytest.approx([NODES.removed[0][0], NODES.removed[-1][3]], rel=1e-12, abs=0.0)


@pytest.mark.parametrize(
    "shape",
    [
        lambda x, y: 3e-6 + 0.0 * x * y,
        lambda x, y: 4e-2 * x * y,
        lambda x, y: 1e-2 * (x - 12e-3) ** 2 + 3e-2 * y**2,
        lambda x, y: 20.0 * (x - 9e-3) ** 2 * y * (1.0 + 50.0 * y),
    ],
    ids=["constant", "twist", "crowning", "biquadratic"],
)
def test_what_is_quadratic_in_either_direction_is_reproduced(shape: Any) -> None:
    roll, face = inside()
    assert sampled(shape).material_removed(roll, face) == pytest.approx(
        shape(roll, face), rel=1e-9, abs=1e-18
    )


def test_the_surface_and_its_slopes_are_continuous() -> None:
    """Slopes from either side of every node line agree; a bilinear surface would have kinks there."""
    step, jumps, slopes = 1e-8, [], []
    for axis, others in ((0, FACE), (1, ROLL)):
        between = np.linspace(others[0], others[-1], 23)
        for node in (ROLL, FACE)[axis][1:-1]:
            at = [np.full(23, node + shift) for shift in (-step, 0.0, step)]
            places = [(a, between) if axis == 0 else (between, a) for a in at]
            low, here, high = (NODES.material_removed(*place) for place in places)
            jumps.append(np.abs((high - here) - (here - low)).max() / step)
            slopes.append(np.abs(high - low).max() / (2 * step))
    assert max(jumps) < 1e-4 * max(slopes)


def test_a_smooth_flank_is_met_at_third_order() -> None:
    def worst(count: int) -> float:
        roll, face = np.linspace(4e-3, 19e-3, count), np.linspace(-12.5e-3, 12.5e-3, count)
        nodes = FlankGrid(roll, face, 1e-5 * np.sin(300.0 * roll)[:, None] * np.cos(150.0 * face))
        x, y = inside(83)
        return float(
            np.abs(nodes.material_removed(x, y) - 1e-5 * np.sin(300.0 * x) * np.cos(150.0 * y)).max()
        )

    assert np.log2(worst(21) / worst(41)) > 2.7


@pytest.mark.parametrize(("first", "swing"), [(4, 2.0 / 27.0), (2, 1.0 / 8.0)], ids=["inside", "border"])
def test_swings_beside_a_step_are_what_is_said(first: int, swing: float) -> None:
    """Cubic with slopes 0 and D/2, or -D/2 and D/2 at the border: 2/27 or 1/8 of the step D h."""
    roll = np.linspace(4e-3, 19e-3, 9)
    step = FlankGrid(roll, (-1e-3, 1e-3), np.where(np.arange(9) >= first, 10e-6, 0.0)[:, None] + np.zeros(2))
    at = np.linspace(4e-3, 19e-3, 4001)
    removed = step.material_removed(at, np.zeros(4001))
    assert -removed.min() == pytest.approx(10e-6 * swing, rel=1e-4, abs=0.0)


def test_where_a_grid_belongs_depends_on_whether_it_differs_over_the_face() -> None:
    even = FlankModification(flank_grid=sampled(lambda x, y: 1e-3 * (x - 4e-3)), helix_crowning=1e-6)
    assert even.along_profile.flank_grid is even.flank_grid
    assert even.along_face.flank_grid is None
    free = FlankModification(flank_grid=NODES, profile_slope=1e-6)
    assert free.along_face.flank_grid is NODES
    assert free.along_profile == FlankModification(profile_slope=1e-6)
    assert free.along_face.varies_along_profile
    assert free.varies_along_face
    assert FlankModification(flank_grid=sampled(lambda x, y: 0.0 * x * y)).neutral


def test_a_grid_adds_to_the_other_amounts_and_tells_flanks_apart(make_gear: Callable[..., Gear]) -> None:
    alone, slope = FlankModification(flank_grid=NODES), FlankModification(profile_slope=4e-6)
    gear = make_gear(modification=FlankModification(flank_grid=NODES, profile_slope=4e-6))
    roll, face = inside(9)
    total = gear.modification.material_removed(gear, roll, face)
    parts = alone.material_removed(gear, roll, face) + slope.material_removed(gear, roll, face)
    assert total == pytest.approx(parts, rel=1e-12, abs=1e-20)
    assert hash(gear) != hash(make_gear())
    assert asdict(gear)["modification"]["flank_grid"]["roll_length"] == ROLL


ZEROS = ((0.0, 0.0), (0.0, 0.0))


@pytest.mark.parametrize(
    ("roll", "face", "removed", "named"),
    [
        ((5e-3, 4e-3), (0.0, 1e-3), ZEROS, "roll_length"),
        ((4e-3, 5e-3), (0.0, 0.0), ZEROS, "face_position"),
        ((4e-3, float("nan")), (0.0, 1e-3), ZEROS, "roll_length"),
        ((4e-3,), (0.0, 1e-3), ZEROS[:1], "roll_length"),
        ((4e-3, 5e-3), (0.0, 1e-3), ZEROS[:1], "removed"),
        ((4e-3, 5e-3), (0.0, 1e-3), (ZEROS[0], (0.0,)), "removed[1]"),
        ((4e-3, 5e-3), (0.0, 1e-3), (ZEROS[0], (0.0, float("nan"))), "removed[1][1]"),
        ((4e-3, 5e-3), (0.0, 1e-3), ((0.0, 5.0), ZEROS[0]), "removed[0][1]"),
    ],
)
def test_unusable_grids_name_the_place(roll: Any, face: Any, removed: Any, named: str) -> None:
    with pytest.raises(InputError) as caught:
        FlankGrid(roll, face, removed)
    assert caught.value.field == named


@pytest.mark.parametrize(
    ("roll", "face", "named"),
    [((4.0, 19.0), (-1e-3, 1e-3), "roll_length"), ((4e-3, 19e-3), (20e-3, 45e-3), "face_position")],
)
def test_a_grid_beside_the_flank_is_refused(
    make_gear: Callable[..., Gear], roll: Any, face: Any, named: str
) -> None:
    with pytest.raises(InputError) as caught:
        make_gear(modification=FlankModification(flank_grid=FlankGrid(roll, face, ((1e-6, 0.0), (0.0, 0.0)))))
    assert caught.value.field == f"modification.flank_grid.{named}"
