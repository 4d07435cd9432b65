"""Hulls with fewer panels: closed and fine enough where walls are thin too, and as loud as the fine hull."""

from functools import cache

import numpy as np
import pytest
from hulls import box
from reduced_housings import bare_housing
from sounding_housings import smooth_motion, with_surface

from dynamics.acoustics import Air, ElementalRadiators, Hull, OuterHull, outer_hull, resistance
from dynamics.noise import radiating_hull
from dynamics.noise.coarse_hull import settled_cells, split_cells, surface_cells

AIR, HERTZ = Air(), 3000.0
BODIES = {
    "block": ((0.3, 0.2, 0.15), (30, 20, 15)),
    "plate": ((0.3, 0.2, 0.003), (60, 40, 1)),
    "wall": ((0.3, 0.2, 0.01), (60, 40, 2)),
    "rod": ((0.3, 0.01, 0.01), (150, 5, 5)),
}


@cache
def body(name: str) -> OuterHull:
    hull, bare = box(*BODIES[name]), bare_housing(modal=4)
    return outer_hull(with_surface(bare, hull, smooth_motion(hull, len(bare.stiffness))))


@pytest.mark.parametrize("name", BODIES)
def test_it_is_closed_fine_enough_and_has_far_fewer_panels(name):
    coarse, fine = radiating_hull(body(name), HERTZ, AIR.sound_speed).hull, body(name).hull
    assert coarse.closed
    assert coarse.longest_edge * HERTZ <= AIR.sound_speed / 6.0
    assert len(coarse.triangles) < 0.4 * len(fine.triangles)


@pytest.mark.parametrize("name", BODIES)
def test_it_displaces_the_volume_of_the_fine_hull(name):
    coarse, fine = radiating_hull(body(name), HERTZ, AIR.sound_speed), body(name)
    displaced = fine.hull.areas @ fine.shapes
    scale = 1e-12 * np.abs(fine.shapes).max() * fine.hull.area
    np.testing.assert_allclose(coarse.hull.areas @ coarse.shapes, displaced, rtol=1e-9, atol=scale)


@pytest.mark.parametrize("name", BODIES)
def test_it_radiates_as_the_fine_hull_does(name):
    coarse, fine = radiating_hull(body(name), HERTZ, AIR.sound_speed), body(name)
    powers = [
        np.diag(resistance(ElementalRadiators(), hull, HERTZ, shapes.astype(complex), AIR)).real
        for hull, shapes in ((coarse.hull, coarse.shapes), (fine.hull, fine.shapes))
    ]
    loud = powers[1] > 1e-3 * powers[1].max()
    np.testing.assert_allclose(10.0 * np.log10(powers[0][loud] / powers[1][loud]), 0.0, atol=0.5)


def test_chosen_cells_alone_are_split():
    hull = body("block").hull
    cell = surface_cells(hull, 200)
    chosen = np.isin(np.arange(cell.max() + 1), [3, 50])
    assert split_cells(hull, cell, chosen).max() == cell.max() + 2
    assert split_cells(hull, cell, np.zeros_like(chosen)).max() == cell.max()


@pytest.mark.parametrize("divisions", [(12, 8, 6), (60, 60, 60)])
def test_a_part_of_the_surface_without_a_seed_is_one_cell(divisions):
    """A closed hull in two parts, below and above the 10 000 nodes from which -9999 is an index."""
    first, second = box((0.3, 0.2, 0.15), divisions), box((0.1, 0.1, 0.1), (4, 4, 4))
    count = len(first.nodes)
    nodes = np.concatenate([first.nodes, second.nodes + np.array([1.0, 0.0, 0.0])])
    hull = Hull(nodes, np.concatenate([first.triangles, second.triangles + count]))
    seeds = np.arange(count)  # whatever node an index takes, it has a cell of the first part
    cell = settled_cells(hull, seeds, 1)
    assert len(np.unique(cell[count:])) == 1
    assert len(np.unique(cell)) == count + 1
