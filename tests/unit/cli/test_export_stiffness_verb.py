"""``loa export --for``: mesh stiffness for rotor and torsion libraries, and the libraries that take it."""

import math
import runpy
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command_line import loa, printed
from small_table import BASE_RADIUS, small_table

FORCE = 100.0 / BASE_RADIUS


@pytest.fixture
def table(tmp_path):
    file = tmp_path / "ste.nc"
    small_table().to_netcdf(file)
    return file


def written(table: Path, library: str, *options: object) -> dict[str, Any]:
    """Return the names of the file that is written for a library."""
    output = table.with_name("stiffness.py")
    assert loa("export", table, "--for", library, "-o", output, *options).exit_code == 0
    return runpy.run_path(str(output))


@pytest.mark.law
def test_stiffness_is_force_over_transmission_error_at_every_position(table):
    answer = printed("export", table, "--for", "json", "-o", table.with_name("k.json"), "--torque", 100)
    at, stiffness = (np.array(answer[name]) for name in ("position_base_pitches", "stiffness_n_per_m"))
    ste = small_table().curve(torque=100.0, at=at).ste
    assert answer["transverse_force_n"] == pytest.approx(FORCE, rel=1e-12)
    np.testing.assert_allclose(stiffness * ste, FORCE, rtol=1e-12)
    mean = small_table().mean(torque=100.0)
    assert answer["mean_stiffness_n_per_m"] * mean.value == pytest.approx(FORCE, rel=1e-12)
    spectrum = np.fft.rfft(stiffness) / stiffness.size
    assert answer["harmonics_n_per_m"][0] == pytest.approx(2.0 * abs(spectrum[1]), rel=1e-12)
    loads, rows = answer["loads_n"], answer["stiffness_over_loads_n_per_m"]
    assert len(loads) == len(rows) == small_table().force.size


def test_ross_gets_a_closed_pitch_of_the_driving_gear(table):
    names = written(table, "ross", "--torque", 100)
    angle, stiffness = names["theta_range"], names["stiffness_range"]
    assert angle[-1] == pytest.approx(2.0 * math.pi / small_table().geometry.teeth[0], rel=1e-12)
    assert angle.size == stiffness.size
    assert stiffness[0] == stiffness[-1]
    assert stiffness.min() < names["gear_mesh_stiffness"] < stiffness.max()


def test_ross_turns_on_it(table):
    """Two rotors that the mesh couples take the stiffness over the angle from the file."""
    ross = pytest.importorskip("ross")
    names, steel = written(table, "ross", "--torque", 100), ross.materials.steel
    body = {"m": 1.0, "Id": 1e-3, "Ip": 2e-3, "n_teeth": 20, "pr_angle": 0.349}
    gears = [ross.GearElement(n=0, base_diameter=2.0 * BASE_RADIUS, **body) for _ in range(2)]
    shafts = [ross.ShaftElement(L=0.05, idl=0.0, odl=0.04, material=steel) for _ in range(2)]
    bearings = [[ross.BearingElement(n=n, kxx=1e12, cxx=0.0) for n in (0, 1)] for _ in range(2)]
    parts = zip(shafts, gears, bearings, strict=True)
    rotors = [ross.Rotor([shaft], [gear], bearing) for shaft, gear, bearing in parts]
    pair = ross.MultiRotor(*rotors, coupled_nodes=(0, 0), gear_mesh_stiffness=1e8)
    names["use_in"](pair)
    middle = 0.5 * names["theta_range"][-1]
    expected = np.interp(middle, names["theta_range"], names["stiffness_range"])
    assert pair.mesh.interpolate_stiffness(middle) == pytest.approx(expected, rel=1e-12)
    assert pair.mesh.stiffness == names["gear_mesh_stiffness"]


def test_opentorsion_couples_two_gears_by_it(table):
    """A turn of either gear shortens the mesh by its base radius: k_mesh r r' between them."""
    torsion = pytest.importorskip("opentorsion")
    names = written(table, "opentorsion", "--torque", 100)
    radii = names["R_driving"], names["R_driven"]
    parent = torsion.Gear(0, 2e-3, radii[0])
    child = torsion.ElasticGear(1, 3e-3, radii[1], k=names["k"], c=0.0, parent=parent)
    shaft = torsion.Shaft(1, 2, L=None, odl=None, k=1e4, I=1e-4)
    train = torsion.Assembly([shaft], elastic_gear_elements=[child])
    coupled = names["k_mesh"] * np.outer(radii, radii)
    np.testing.assert_allclose(train.K[0, :2], coupled[0], rtol=1e-12)
    assert train.K[1, 1] == pytest.approx(coupled[1, 1] + 1e4, rel=1e-12)


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        (["--for", "adams"], "--for = 'adams': must be one of ross, opentorsion, json"),
        (["--for", "json", "--torque", 1, "--force", 1], "not both"),
    ],
)
def test_arguments_it_cannot_use(table, arguments, text):
    result = loa("export", table, "-o", table.with_name("k.py"), *arguments)
    assert result.exit_code == 2
    assert text in result.stderr
