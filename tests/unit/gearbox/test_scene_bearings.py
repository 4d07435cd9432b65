"""Bearings of a scene file: matrices, preload and housings, from the file or beside it."""

import json
import math
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from changed_scenes import DROP, By, changed_scene, check_refused
from repository import ROOT
from small_table import small_table

from dynamics.assembly.assemble import assemble
from dynamics.bearings import BallBearing, PlanetBearing, RollerBearing
from dynamics.bearings.catalog import from_catalog
from dynamics.housings import ReducedHousing, ReducedMatrices, Ring, SeatFrame, housing_of_matrices
from dynamics.integrators import static_equilibrium
from dynamics.mechanism.bodies import modal_housing
from lineofaction.gearbox.convert.declared import in_si
from lineofaction.gearbox.convert.scene import dynamic_scene
from lineofaction.gearbox.convert.scene_parts import _laws_of
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas import read_model, validated
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.subjects import scene_inputs

EXAMPLE = tomllib.loads((ROOT / "examples" / "palermo_scene.toml").read_text())
MATRIX = (1e8 * np.diag([1.0, 1.0, 0.5, 0.01, 0.01])).tolist()
HOUSING = (1e9 * (np.eye(6) + 0.1)).tolist()
MASS = (5.0 * np.eye(6) + 1.0).tolist()
SEATS = [[0.0, 0.0, part["position_mm"]] for part in EXAMPLE["bushings"][:2]]


def test_matrices_and_preload_reach_the_bushing_as_they_are():
    own = {"stiffness_matrix": MATRIX, "damping_matrix": MATRIX, "preload_force_n": [0.0, 0.0, 500.0]}
    own |= {"radial_stiffness_n_per_m": DROP}
    changes = {f"bushings[0].{name}": value for name, value in own.items()}
    bushing = changed_scene(EXAMPLE, changes).bushings[0]
    assert (bushing.radial_stiffness, bushing.preload) == (0.0, (0.0, 0.0, 500.0, 0.0, 0.0))
    np.testing.assert_array_equal(bushing.stiffness, MATRIX)
    np.testing.assert_array_equal(bushing.damping, MATRIX)
    assert changed_scene(EXAMPLE).bushings[0].stiffness is None


def test_rolling_contacts_and_curves_are_in_si():
    curves = [
        {"direction": "x", "displacement_um": [-40.0, 0.0, 40.0], "force_n": [-6e3, 0.0, 5e3]},
        {"direction": "tilt_y", "tilt_mrad": [-1.0, 1.0], "moment_n_m": [-50.0, 50.0]},
    ]
    found = changed_scene(
        EXAMPLE,
        {f"bushings[{k}].radial_stiffness_n_per_m": DROP for k in (0, 1)}
        | {"bushings[0].rolling_contact": {"stiffness_n_per_m_n": 5e8, "radial_clearance_um": 20.0}}
        | {"bushings[1].spring_curves": curves},
    )
    (contact,), (line, tilt) = found.rolling_contacts, found.spring_curves
    assert (contact.bushing, contact.stiffness, contact.exponent) == ("input left", 5e8, 10.0 / 9.0)
    assert contact.clearance == pytest.approx(20e-6, rel=1e-12, abs=0.0)
    assert (line.bushing, line.direction, line.force) == ("input right", "x", (-6e3, 0.0, 5e3))
    np.testing.assert_allclose(line.displacement, [-40e-6, 0.0, 40e-6], rtol=1e-12, atol=0.0)
    np.testing.assert_allclose(tilt.displacement, [-1e-3, 1e-3], rtol=1e-12)


BALL = {"count": 7, "diameter_mm": 11.5, "pitch_diameter_mm": 43.5, "clearance_um": 10.0}
TAPERED = {"count": 17, "diameter_mm": 9.0, "length_mm": 13.6, "pitch_diameter_mm": 65.0}
LINE = {"bore_mm": 25.0, "outside_diameter_mm": 62.0, "static_rating_n": 11600.0, "clearance_um": 10.0}


def housing(**fields: Any) -> By:
    names = [bushing["name"] for bushing in EXAMPLE["bushings"][:2]]
    return By(housings=[{"name": "case", "bushings": names, "stiffness_matrix": HOUSING} | fields])


def rolling(**row: Any) -> By:
    """Return changes that put a rolling bearing in place of the first bushing."""
    bushing = EXAMPLE["bushings"][0]
    place = {name: bushing[name] for name in ("name", "shaft", "position_mm")}
    return By({"bushings[0]": DROP, "rolling_bearings": [place | row]})


def test_rolling_bearings_are_in_si_by_geometry_or_by_their_line():
    (balls,) = changed_scene(EXAMPLE, rolling(ball=BALL)).rolling_bearings
    assert (balls.name, balls.shaft, balls.row.count) == ("input left", "input", 7)
    assert balls.row == BallBearing(7, 11.5 * 1e-3, 43.5 * 1e-3, clearance=10.0 * 1e-6)
    angle = {"contact_angle_deg": -15.0}
    (taper,) = changed_scene(
        EXAMPLE, rolling(roller=TAPERED | angle, axial_preload_n=-500.0)
    ).rolling_bearings
    assert isinstance(taper.row, RollerBearing)
    assert taper.row.contact_angle == pytest.approx(math.radians(-15.0), rel=1e-12)
    assert (taper.axial_preload, taper.row.length) == (-500.0, pytest.approx(13.6e-3, rel=1e-12))
    (line,) = changed_scene(EXAMPLE, rolling(catalog=LINE, damping_ratio=0.1)).rolling_bearings
    assert line.row == from_catalog(25.0 * 1e-3, 62.0 * 1e-3, 11600.0, 10.0 * 1e-6)
    assert line.damping_ratio == 0.1


def test_planet_bearings_have_all_that_bushings_have():
    """Each copy of the planet with its own law; a bearing that states nothing is refused."""
    table = tomllib.loads((ROOT / "examples" / "planetary_scene.toml").read_text())
    del table["planet_bearings"][0]["radial_stiffness_n_per_m"]
    contact = {"stiffness_n_per_m_n": 5e8, "radial_clearance_um": 20.0}
    curve = {"direction": "tilt_y", "tilt_mrad": [-1.0, 1.0], "moment_n_m": [-50.0, 50.0]}
    table["planet_bearings"][0] |= {
        "rolling_contact": contact,
        "spring_curves": [curve],
        "stiffness_matrix": MATRIX,
        "damping_matrix": MATRIX,
    }
    given = validated(SceneInput, table)
    (contact_law,), (curve_law,) = (_laws_of(kind, given) for kind in ("rolling_contacts", "spring_curves"))
    assert (contact_law.bushing, contact_law.clearance) == ("pin", pytest.approx(20e-6, rel=1e-12, abs=0.0))
    assert (curve_law.bushing, curve_law.direction) == ("pin", "tilt_y")
    bearing = PlanetBearing(**in_si(PlanetBearing, given.planet_bearings[0]))
    np.testing.assert_array_equal(bearing.stiffness, MATRIX)
    np.testing.assert_array_equal(bearing.damping, MATRIX)
    for field in ("rolling_contact", "spring_curves", "stiffness_matrix"):
        del table["planet_bearings"][0][field]
    with pytest.raises(BadInput, match=r"planet_bearings\[0\]\.radial_stiffness_n_per_m"):
        validated(SceneInput, table)


@pytest.mark.parametrize("suffix", [".csv", ".npz"])
def test_a_housing_file_is_written_out_in_the_scene(tmp_path, suffix):
    file, name = tmp_path / "scene.toml", f"case{suffix}"
    if suffix == ".csv":
        np.savetxt(tmp_path / name, HOUSING, delimiter=",")
    else:
        np.savez(tmp_path / name, stiffness=HOUSING, mass=np.eye(6))
    text = (ROOT / "examples" / "palermo_scene.toml").read_text()
    names = ", ".join(f'"{bushing["name"]}"' for bushing in EXAMPLE["bushings"][:2])
    part = f'\n[[housings]]\nname = "case"\nbushings = [{names}]\nstiffness_file = "{name}"\n'
    file.write_text(text + part)
    given = read_model(SceneInput, file)
    np.testing.assert_array_equal(given.housings[0].stiffness_matrix, HOUSING)
    found = dynamic_scene(given, {"mesh": small_table()})
    np.testing.assert_array_equal(found.housings[0].stiffness, HOUSING)
    assert (found.housings[0].mass is None) == (suffix == ".csv")


def reduced(path: Path, off: float = 0.0) -> ReducedHousing:
    """Write a housing under the first two bearings, one mode inside; the second seat is `off` (m) along z."""
    origin = {shaft["name"]: shaft.get("origin_mm", [0.0, 0.0, 0.0]) for shaft in EXAMPLE["shafts"]}
    seats = []
    for index, bushing in enumerate(EXAMPLE["bushings"][:2]):
        x, y, z = origin[bushing["shaft"]]
        at = 1e-3 * np.array([x, y, z + bushing["position_mm"]]) + np.array([0.0, 0.0, off * index])
        axes = np.diag([1.0, -1.0, -1.0]) if index else np.eye(3)
        seats.append(SeatFrame(bushing["name"], at, axes, Ring.RIGID, ("x", "y", "z")))
    stiffness, mass = np.diag([*np.diag(HOUSING), 4e7]), np.eye(7)
    stiffness[:6, :6], mass[0, 6], mass[6, 0] = HOUSING, 0.3, 0.3
    housing = housing_of_matrices(ReducedMatrices(stiffness, mass), tuple(seats))
    housing.to_netcdf(path)
    return housing


def test_a_reduced_housing_is_written_out_in_the_scene(tmp_path):
    """Its seats name the bearings; the one whose bore points down turns y and z over."""
    housing, file = reduced(tmp_path / "case.nc"), tmp_path / "scene.toml"
    text = (ROOT / "examples" / "palermo_scene.toml").read_text()
    file.write_text(text + '\n[[housings]]\nname = "case"\nmodes_file = "case.nc"\n')
    found = dynamic_scene(read_model(SceneInput, file), {"mesh": small_table()}).housings[0]
    assert found.bushings == tuple(part["name"] for part in EXAMPLE["bushings"][:2])
    assert found.modal_coordinates == 1
    over = np.diag([1.0, 1.0, 1.0, 1.0, -1.0, -1.0, 1.0])
    for name in ("stiffness", "damping", "mass"):
        np.testing.assert_array_equal(getattr(found, name), over @ getattr(housing, name) @ over)
    square = modal_housing(found).stiffness
    np.testing.assert_allclose(np.sqrt(square), housing.modes[0], rtol=1e-9)


def test_a_client_sends_the_matrices_of_a_reduced_housing(tmp_path):
    """Not the name of its file, which no service opens."""
    reduced(tmp_path / "case.nc")
    text = (
        (ROOT / "examples" / "palermo_scene.toml")
        .read_text()
        .replace('"palermo', f'"{ROOT}/examples/palermo')
    )
    (tmp_path / "scene.toml").write_text(text + '\n[[housings]]\nname = "case"\nmodes_file = "case.nc"\n')
    sent = json.loads(json.dumps(scene_inputs(tmp_path / "scene.toml")))
    assert "case.nc" not in json.dumps(sent)
    expected = dynamic_scene(
        read_model(SceneInput, tmp_path / "scene.toml"), {"mesh": small_table()}
    ).housings
    assert dynamic_scene(validated(SceneInput, sent["scene"]), {"mesh": small_table()}).housings == expected


@pytest.mark.parametrize(
    ("line", "off", "field"),
    [
        ('modes_file = "none.nc"', 0.0, "housings[0].modes_file"),
        ('modes_file = "scene.toml"', 0.0, "housings[0].modes_file"),
        ('modes_file = "case.nc"\nstiffness_file = "case.csv"', 0.0, "housings[0].stiffness_file"),
        ("modes_file = 3", 0.0, "housings[0].modes_file"),
        ('modes_file = "case.nc"', 0.01, "housings[0].seat_positions_mm[1]"),
    ],
)
def test_a_reduced_housing_that_does_not_fit_is_named(tmp_path, line, off, field):
    reduced(tmp_path / "case.nc", off)
    part = f'\n[[housings]]\nname = "case"\n{line}\n'
    (tmp_path / "scene.toml").write_text((ROOT / "examples" / "palermo_scene.toml").read_text() + part)
    with pytest.raises(BadInput) as caught:
        dynamic_scene(read_model(SceneInput, tmp_path / "scene.toml"), {"mesh": small_table()})
    assert caught.value.faults[0].field == field
    assert off == 0.0 or "10 mm" in str(caught.value.faults[0])


def test_a_housing_has_its_mass_from_the_file():
    own = housing(mass_matrix=MASS, damping_ratio=0.01, seat_positions_mm=SEATS)
    found = changed_scene(EXAMPLE, own).housings[0]
    np.testing.assert_array_equal(found.mass, MASS)
    assert found.damping_ratio == 0.01
    bare = validated(SceneInput, EXAMPLE | housing())
    earlier = {"name", "bushings", "stiffness_matrix", "damping_matrix"}  # stored results keep their address
    assert set(bare.model_dump(mode="json")["housings"][0]) == earlier


def test_a_rolling_bearing_sits_in_a_housing_with_mass():
    found = changed_scene(EXAMPLE, housing(mass_matrix=MASS) | rolling(ball=BALL))
    system = assemble(found)
    assert [part.bearings for part in system.rotors.housings] == [("input left", "input right")]
    assert static_equilibrium(system).status.usable


HEAP, RATING = BALL | {"count": 20}, LINE | {"static_rating_n": 11.6}
X_CURVE = {"displacement_um": [0.0, 1.0], "force_n": [0.0, 1.0]}
FREE = housing(stiffness_matrix=np.diag([1e8, 1e8, 0.0, 1e8, 1e8, 1e8]).tolist())
WRONG: dict[str, tuple[str, Any]] = {
    "no stiffness": ("bushings[0].radial_stiffness_n_per_m", DROP),
    "not symmetric": ("bushings[0].stiffness_matrix", (np.eye(5) + np.eye(5, k=1)).tolist()),
    "holds the rotation": ("bushings[0].stiffness_matrix", np.eye(6).tolist()),
    "negative damping": ("bushings[0].damping_matrix", (-np.eye(5)).tolist()),
    "falling curve": (
        "bushings[0].spring_curves[0].force_n",
        By({"bushings[0].spring_curves": [X_CURVE | {"direction": "x", "force_n": [1.0, 0.0]}]}),
    ),
    "curve of another direction": (
        "bushings[0].spring_curves[0].displacement_um",
        By({"bushings[0].spring_curves": [X_CURVE | {"direction": "tilt_x"}]}),
    ),
    "two rows": ("rolling_bearings[0].ball", rolling(ball=BALL, catalog=LINE)),
    "no row": ("rolling_bearings[0].ball", rolling()),
    "balls in a heap": ("rolling_bearings[0].ball.pitch_diameter_mm", rolling(ball=HEAP)),
    "a rating of no such bearing": (
        "rolling_bearings[0].catalog.static_rating_n",
        rolling(catalog=RATING),
    ),
    "preload the other way": (
        "rolling_bearings[0].axial_preload_n",
        rolling(roller=TAPERED | {"contact_angle_deg": 15.0}, axial_preload_n=-500.0),
    ),
    "unknown bushing": ("housings[0].bushings[1]", housing(bushings=["input left", "x"])),
    "wrong size": ("housings[0].stiffness_matrix", housing(stiffness_matrix=np.eye(7).tolist())),
    "damping of another size": ("housings[0].damping_matrix", housing(damping_matrix=np.eye(10).tolist())),
    "a motion without mass": (
        "housings[0].mass_matrix",
        housing(mass_matrix=np.diag([1.0, 1.0, 1.0, 1.0, 1.0, 0.0]).tolist()),
    ),
    "modes without mass": (
        "housings[0].modal_coordinates",
        housing(stiffness_matrix=np.eye(7).tolist(), modal_coordinates=1),
    ),
    "seats elsewhere": (
        "housings[0].seat_positions_mm[1]",
        housing(seat_positions_mm=[SEATS[0], [0.0, 0.0, -50.0]]),
    ),
    "a law in a housing that a direction of a seat moves freely": (
        "housings[0].stiffness_matrix",
        By(FREE | rolling(ball=BALL)),
    ),
    "a file over HTTP": ("housings[0].stiffness_file", housing(stiffness_file="case.csv")),
}


@pytest.mark.parametrize("name", WRONG)
def test_bearings_that_cannot_be_are_one_fault_by_name(name):
    check_refused(EXAMPLE, *WRONG[name])


def test_a_bearing_twice_is_refused_by_the_fields_of_a_bushing():
    with pytest.raises(BadInput) as caught:
        changed_scene(EXAMPLE, {"rolling_bearings": [{**EXAMPLE["bushings"][0], "ball": BALL}]})
    assert "rolling_bearings[0].radial_stiffness_n_per_m" in [fault.field for fault in caught.value.faults]


@pytest.mark.parametrize(("name", "text"), [("none.csv", None), ("x.csv", "1,2\n3"), ("x.txt", "1")])
def test_a_housing_file_that_cannot_be_read_is_named(tmp_path, name, text):
    if text is not None:
        (tmp_path / name).write_text(text)
    part = f'\n[[housings]]\nname = "case"\nbushings = ["a"]\nstiffness_file = "{name}"\n'
    (tmp_path / "scene.toml").write_text((ROOT / "examples" / "palermo_scene.toml").read_text() + part)
    with pytest.raises(BadInput) as caught:
        read_model(SceneInput, tmp_path / "scene.toml")
    assert caught.value.faults[0].field == "housings[0].stiffness_file"
