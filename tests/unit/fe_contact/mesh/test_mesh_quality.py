"""Laws of element quality."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from fe_contact.errors import MeshError
from fe_contact.geometry import Gear
from fe_contact.mesh import MeshRecipe, QualityLimits, mesh_gear, mesh_quality
from fe_contact.mesh.outline import Outline, Piece
from fe_contact.mesh.triangulation import _quadratic_mesh, _Triangulation

STRAIGHT = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.5, 0.0], [0.5, 0.5], [0.0, 0.5]])
ELEMENT = np.arange(6)[None, :]


def test_a_straight_triangle_has_constant_jacobian_and_its_least_angle() -> None:
    quality = mesh_quality(STRAIGHT * [3.0, 1.0], ELEMENT)
    assert quality.scaled_jacobian[0] == pytest.approx(1.0, abs=1e-14)
    assert quality.angle[0] == pytest.approx(np.arctan(1.0 / 3.0), rel=1e-14)


@pytest.mark.parametrize("shift", [0.05, 0.2, -0.2, 0.3])
def test_the_bound_of_a_curved_element_is_below_its_sampled_jacobian(shift: float) -> None:
    nodes = STRAIGHT.copy()
    nodes[3, 1] += shift
    xi, eta = np.meshgrid(np.linspace(0.0, 1.0, 101), np.linspace(0.0, 1.0, 101))
    inside = xi + eta <= 1.0
    # x = xi, y = eta + 4 shift xi (1 - xi - eta), so det J = 1 - 4 shift xi: least at a corner.
    determinant = (1.0 - 4.0 * shift * xi)[inside]
    expected = determinant.min() / np.abs(determinant).max()
    found = mesh_quality(nodes, ELEMENT).scaled_jacobian[0]
    assert found <= expected + 1e-14
    assert found == pytest.approx(expected, abs=0.02)
    assert (found < 0.0) == (shift > 0.25)


def test_the_bound_holds_for_any_element() -> None:
    generator = np.random.default_rng(7)
    xi, eta = np.meshgrid(np.linspace(0.0, 1.0, 41), np.linspace(0.0, 1.0, 41))
    inside = xi + eta <= 1.0 + 1e-12
    x, y = xi[inside], eta[inside]
    z = 1.0 - x - y
    in_x = np.stack([1 - 4 * z, 4 * x - 1, 0 * x, 4 * (z - x), 4 * y, -4 * y])
    in_y = np.stack([1 - 4 * z, 0 * x, 4 * y - 1, -4 * x, 4 * x, 4 * (z - y)])
    below_every_node = 0
    for _ in range(300):
        nodes = STRAIGHT + 0.07 * generator.standard_normal((6, 2))
        (a, b), (c, d) = nodes.T @ in_x, nodes.T @ in_y
        determinant = a * d - b * c
        found = mesh_quality(nodes, ELEMENT).scaled_jacobian[0]
        if found > 0.0:
            assert found <= determinant.min() / determinant.max() + 1e-12
        assert found < 0.0 or determinant.min() > 0.0
        at_nodes = [determinant[(x == p) & (y == q)][0] for p, q in STRAIGHT]
        below_every_node += determinant.min() < min(at_nodes) - 1e-3
    assert below_every_node > 10  # values at the nodes alone would be no bound


def test_an_inverted_element_is_negative() -> None:
    assert mesh_quality(STRAIGHT, ELEMENT[:, [0, 2, 1, 5, 4, 3]]).scaled_jacobian[0] < 0.0


def test_a_missed_limit_names_element_value_and_limit() -> None:
    gear = Gear(teeth=20, normal_module=4e-3, face_width=25e-3, bore_diameter=40e-3)
    with pytest.raises(
        MeshError, match=r"tooth sector: element \d+ at .* mm: least angle .* deg is below 59 deg"
    ):
        mesh_gear(gear, limits=QualityLimits(angle=np.radians(59.0)))
    with pytest.raises(MeshError, match=r"scaled Jacobian 0\.\d+ is below 1"):
        mesh_gear(gear, limits=QualityLimits(scaled_jacobian=1.0))


def test_a_recipe_that_cannot_be_meshed_well_is_refused() -> None:
    gear = Gear(teeth=20, normal_module=4e-3, face_width=25e-3, bore_diameter=40e-3)
    # Two plain teeth between few real ones: sides of 0.1 mm meet edges of several mm.
    recipe = replace(MeshRecipe.standard(gear), fillet_size=20e-3, body_size=20e-3, growth=1.0)
    with pytest.raises(MeshError):
        mesh_gear(gear, recipe, limits=QualityLimits(angle=np.radians(30.0), scaled_jacobian=0.6))


def test_an_outline_edge_that_was_divided_is_an_error() -> None:
    points = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.5, 0.0]])
    straight = _Triangulation(points, np.array([[0, 3, 2], [3, 1, 2]]))
    nodes = np.array([[0.0, 0.0], [0.5, 0.0], [1.0, 0.0], [0.5, 0.5], [0.0, 1.0], [0.0, 0.5], [0.0, 0.0]])
    with pytest.raises(MeshError, match="divided"):
        _quadratic_mesh([Outline((Piece("all", nodes),))], straight)
