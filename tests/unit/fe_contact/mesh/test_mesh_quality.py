"""Element quality, recipes, division of curves, and meshes in files."""

import subprocess
import sys
from dataclasses import fields, replace
from pathlib import Path

import meshio
import numpy as np
import pytest
from repository import ROOT
from spur_gears import GEAR

from fe_contact.compliance.cache import content_hash
from fe_contact.errors import InputError, MeshError
from fe_contact.geometry import Gear
from fe_contact.mesh import GearMesh, MeshRecipe, QualityLimits, mesh_gear, mesh_quality
from fe_contact.mesh.curve_division import divide, middles, spread
from fe_contact.mesh.export import HUB, cell_teeth, write_cells
from fe_contact.mesh.outline import Outline, Piece
from fe_contact.mesh.quadratic_mesh import Triangulation, with_mid_side_nodes

STRAIGHT = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.5, 0.0], [0.5, 0.5], [0.0, 0.5]])
ELEMENT = np.arange(6)[None, :]


def test_a_straight_triangle_has_constant_jacobian_and_an_inverted_one_a_negative():
    quality = mesh_quality(STRAIGHT * [3.0, 1.0], ELEMENT)
    assert quality.scaled_jacobian[0] == pytest.approx(1.0, abs=1e-14)
    assert quality.angle[0] == pytest.approx(np.arctan(1.0 / 3.0), rel=1e-14)
    assert mesh_quality(STRAIGHT, ELEMENT[:, [0, 2, 1, 5, 4, 3]]).scaled_jacobian[0] < 0.0


@pytest.mark.parametrize("shift", [0.05, 0.2, -0.2, 0.3])
def test_the_bound_of_a_curved_element_is_below_its_sampled_jacobian(shift):
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


def test_the_bound_holds_for_any_element():
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


def test_what_cannot_be_meshed_well_is_refused_by_element_and_limit():
    gear = Gear(teeth=20, normal_module=4e-3, face_width=25e-3, bore_diameter=40e-3)
    with pytest.raises(
        MeshError, match=r"tooth sector: element \d+ at .* mm: least angle .* deg is below 59 deg"
    ):
        mesh_gear(gear, limits=QualityLimits(angle=np.radians(59.0)))
    with pytest.raises(MeshError, match=r"scaled Jacobian 0\.\d+ is below 1"):
        mesh_gear(gear, limits=QualityLimits(scaled_jacobian=1.0))
    # Two plain teeth between few real ones: sides of 0.1 mm meet edges of several mm.
    recipe = replace(MeshRecipe.standard(gear), fillet_size=20e-3, body_size=20e-3, growth=1.0)
    with pytest.raises(MeshError):
        mesh_gear(gear, recipe, limits=QualityLimits(angle=np.radians(30.0), scaled_jacobian=0.6))
    points = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.5, 0.0]])
    straight = Triangulation(points, np.array([[0, 3, 2], [3, 1, 2]]))
    nodes = np.array([[0.0, 0.0], [0.5, 0.0], [1.0, 0.0], [0.5, 0.5], [0.0, 1.0], [0.0, 0.5], [0.0, 0.0]])
    with pytest.raises(MeshError, match="divided"):
        with_mid_side_nodes([Outline((Piece("all", nodes),))], straight)


STANDARD = MeshRecipe.standard(GEAR)


def test_refinement_divides_sizes_and_keeps_teeth_and_margin():
    fine = replace(STANDARD, real_teeth=5).refined(2.0)
    for name in ("flank_size", "tip_size", "fillet_size", "body_size", "growth"):
        assert getattr(fine, name) == pytest.approx(0.5 * getattr(STANDARD, name), rel=1e-15)
    assert (fine.real_teeth, fine.flank_margin) == (5, STANDARD.flank_margin)
    twice = STANDARD.refined(2.0).refined(2.0)
    assert twice.flank_size == pytest.approx(STANDARD.refined(4.0).flank_size, rel=1e-15)


def test_every_field_changes_the_hash_in_every_process():
    changed = {
        field.name: replace(STANDARD, **{field.name: 7 if field.name == "real_teeth" else 0.9 * value})
        for field in fields(STANDARD)
        for value in [getattr(STANDARD, field.name) or 1.0]
    }
    hashes = {content_hash(recipe.content()) for recipe in (*changed.values(), STANDARD)}
    assert len(hashes) == len(fields(STANDARD)) + 1
    code = (
        "from fe_contact.compliance.cache import content_hash\nfrom fe_contact.mesh import MeshRecipe\n"
        f"recipe = MeshRecipe({STANDARD.flank_size!r}, {STANDARD.tip_size!r}, {STANDARD.fillet_size!r},"
        f" {STANDARD.body_size!r}, {STANDARD.flank_margin!r})\nprint(content_hash(recipe.content()))"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT)
    assert run.stdout.strip() == content_hash(STANDARD.content())


@pytest.mark.parametrize(("start", "end"), [(0.0, 1.0), (2.0, -1.0)])
def test_ends_are_exact_and_parts_follow_the_size(start, end):
    ends = divide(start, end, lambda t: 0.01 + 0.1 * np.abs(t - end))
    assert (ends[0], ends[-1]) == (start, end)
    lengths = np.abs(np.diff(ends))
    assert np.all(np.diff(ends) * (end - start) > 0.0)
    wanted = 0.01 + 0.1 * np.abs(middles(ends) - end)
    assert lengths == pytest.approx(wanted, rel=0.05)
    assert np.all(lengths <= 1.001 * wanted)


def test_parts_are_whole_and_spread_from_their_sources():
    assert divide(0.0, 1.0, lambda t: np.full_like(t, 5.0)).tolist() == [0.0, 1.0]
    assert len(divide(0.0, 1.0, lambda t: np.full_like(t, 0.1))) == 11
    size = spread(np.array([[0.0, 0.0], [10.0, 0.0]]), np.array([0.1, 1.0]), growth=0.2, largest=1.5)
    found = size(np.array([[0.0, 0.0], [0.0, 3.0], [10.0, 0.0], [50.0, 0.0]]))
    assert found == pytest.approx([0.1, 0.7, 1.0, 1.5])


def export(mesh: GearMesh, path: Path) -> None:
    bore = np.zeros(len(mesh.points))
    bore[mesh.bore_nodes] = 1.0
    points = np.column_stack([mesh.points, np.zeros(len(mesh.points))])
    of_points = {"bore": bore, "height": mesh.points[:, 1].copy()}
    write_cells(path, points, mesh.triangles, of_points, {"tooth": cell_teeth(mesh).astype(float)})


def test_round_trip_but_of_no_other_suffix(tmp_path, gear_and_mesh):
    _, mesh = gear_and_mesh
    export(mesh, tmp_path / "gear.vtu")
    back = meshio.read(tmp_path / "gear.vtu")
    assert np.array_equal(back.points[:, :2], mesh.points)
    assert np.array_equal(back.cells_dict["triangle6"], mesh.triangles)
    assert np.array_equal(back.point_data["height"], mesh.points[:, 1])
    assert np.flatnonzero(back.point_data["bore"]).tolist() == sorted(mesh.bore_nodes.tolist())
    teeth = set(np.unique(back.cell_data["tooth"][0]).astype(int).tolist())
    assert teeth == set(mesh.teeth.tolist()) | ({HUB} if mesh.hub is not None else set())
    with pytest.raises(InputError, match=r"\.vtu"):
        export(gear_and_mesh[1], tmp_path / "gear.stl")
