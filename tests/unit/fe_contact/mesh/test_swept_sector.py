"""Layers and numbering of a swept tooth sector."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from fe_contact.geometry import Gear
from fe_contact.mesh import ClampedBore, PlaneStrain, SectorRecipe, swept_sector
from fe_contact.mesh.sector_grid import SectorGrid
from fe_contact.mesh.swept_sector import _layers_across, _layers_to_mid_face

SPUR = Gear(teeth=20, normal_module=4e-3, face_width=25e-3, bore_diameter=40e-3)
GRID = SectorGrid(body_rows=4, tooth_rows=3, land=1, across=2)
DRAFT = SectorRecipe.draft(SPUR)


@pytest.mark.parametrize(
    ("count", "group", "growth"), [(1, 1, 1.5), (2, 2, 1.5), (8, 2, 1.5), (18, 2, 1.5), (12, 4, 2.0)]
)
def test_layers_fill_the_face_symmetrically(count: int, group: int, growth: float) -> None:
    layers = _layers_across(25e-3, count, group, growth)
    assert (layers.ends[0], layers.ends[-1]) == (-12.5e-3, 12.5e-3)
    assert np.array_equal(layers.ends, -layers.ends[::-1])
    assert np.diff(layers.ends) == pytest.approx(layers.thickness[layers.kind], rel=1e-12)
    assert np.array_equal(
        layers.kind.reshape(-1, group), np.repeat(layers.kind[::group, None], group, axis=1)
    )
    if count // group > 2:
        assert np.diff(layers.ends).max() / np.diff(layers.ends)[0] == pytest.approx(growth)


def test_half_a_face_is_finest_at_its_end() -> None:
    layers = _layers_to_mid_face(25e-3, 3, 8.0)
    assert (layers.ends[0], layers.ends[-1]) == (0.0, 12.5e-3)
    thickness = np.diff(layers.ends)
    assert thickness == pytest.approx(layers.thickness[layers.kind], rel=1e-12)
    assert thickness[:-1] / thickness[1:] == pytest.approx(8.0**0.5)


def test_half_a_face_slides_on_mid_face() -> None:
    recipe = replace(DRAFT, layers=2, merge_rows=())
    half = swept_sector(GRID, 25e-3, replace(recipe, half_face=True))
    whole = swept_sector(GRID, 25e-3, recipe)
    middle = half.nodes[0, half.nodes[0] >= 0]
    free = whole.freedoms[middle] >= 0
    assert np.array_equal(half.freedoms[middle] >= 0, free & [True, True, False])
    above = np.setdiff1d(np.arange(len(half.freedoms)), middle)
    assert np.array_equal(half.freedoms[above] >= 0, whole.freedoms[above] >= 0)


def test_nodes_are_where_serendipity_elements_have_them() -> None:
    sector = swept_sector(GRID, 25e-3, replace(DRAFT, layers=2, merge_rows=()))
    corners = GRID.corner.sum()
    assert sector.nodes.max() + 1 == 3 * GRID.nodes + 2 * corners
    assert len(sector.elements) == 2 * len(GRID.quads)
    assert np.unique(sector.elements).size == sector.nodes.max() + 1
    held = len(GRID.bore) * 3 + (len(GRID.bore) + 1) // 2 * 2
    assert sector.size == 3 * (sector.nodes.max() + 1 - held)
    bottom_middle = sector.elements[0, 8:12]
    assert np.array_equal(bottom_middle, sector.nodes[0, GRID.quads[0, 4:]])
    assert np.array_equal(sector.elements[0, 16:], sector.nodes[1, GRID.quads[0, :4]])


@pytest.mark.parametrize("rows", [(-1,), (-2,), (-1, -3)])
def test_merged_layers_leave_no_node_of_their_own(rows: tuple[int, ...]) -> None:
    whole = swept_sector(GRID, 25e-3, replace(DRAFT, layers=8, merge_rows=()))
    merged = swept_sector(GRID, 25e-3, replace(DRAFT, layers=8, merge_rows=rows))
    assert merged.elements.min() >= 0
    assert np.unique(merged.elements).size == merged.nodes.max() + 1
    assert merged.size < whole.size
    elements = 0
    for row in GRID.cells[:, 1]:
        elements += 8 >> sum(row < r for r in rows)
    assert len(merged.elements) == elements
    assert sorted(np.concatenate([b.elements.ravel() for b in merged.batches])) == list(range(elements))
    # Each coarse layer carries one lower and one upper thin one.
    halves = [b.half for b in merged.batches for _ in b.elements]
    assert halves.count(-1) == halves.count(1) == sum(4 >> i for i in range(len(rows)))


def test_cuts_and_flank_name_matching_freedoms() -> None:
    sector = swept_sector(GRID, 25e-3, replace(DRAFT, layers=4))
    node_of = np.full(sector.size, -1)
    free = sector.freedoms >= 0
    node_of[sector.freedoms[free]] = np.nonzero(free)[0]
    plane_and_column = {n: (p, c) for p, c in np.argwhere(sector.nodes >= 0) for n in [sector.nodes[p, c]]}
    for left, right in zip(sector.left, sector.right, strict=True):
        (p, c), (q, d) = plane_and_column[node_of[left]], plane_and_column[node_of[right]]
        assert p == q
        assert list(GRID.left).index(c) == list(GRID.right).index(d)
    index = sector.flank_index
    assert (index[1::2, 1::2] == -1).all()
    assert sorted(index[index >= 0]) == list(range(len(sector.flank)))
    p, c = np.argwhere(index == 5)[0]
    assert sector.flank[5] == sector.freedoms[sector.nodes[p, GRID.flank[c]], 0]


def test_supports_hold_what_they_say() -> None:
    recipe = replace(DRAFT, layers=1, merge_rows=())
    clamped = swept_sector(GRID, 1e-3, recipe, ClampedBore())
    strain = swept_sector(GRID, 1e-3, recipe, PlaneStrain())
    bore = clamped.nodes[:, GRID.bore]
    assert (clamped.freedoms[bore[bore >= 0]] == -1).all()
    assert clamped.size % 3 == 0
    assert strain.size == clamped.size // 3 * 2
    assert (strain.freedoms[:, 2] == -1).all()


def test_recipes_follow_the_gear() -> None:
    helical, wide = replace(SPUR, helix_angle=0.3), replace(SPUR, face_width=80e-3)
    assert (
        SectorRecipe.draft(SPUR).layers,
        SectorRecipe.standard(SPUR).layers,
        SectorRecipe.fine(SPUR).layers,
    ) == (8, 12, 18)
    assert SectorRecipe.standard(helical).layers == 16
    assert SectorRecipe.standard(wide).layers == 20
    # A helical body keeps at least six layers.
    for recipe in (SectorRecipe.draft(helical), SectorRecipe.standard(helical), SectorRecipe.fine(helical)):
        assert recipe.layers // recipe.layer_group >= 6
    assert SectorRecipe.draft(SPUR).content() != SectorRecipe.standard(SPUR).content()
    assert SectorRecipe.draft(SPUR).content() == SectorRecipe.draft(SPUR).content()
