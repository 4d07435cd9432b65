"""Opening a gear unit does not load what computes, and computing not what searches."""

import subprocess
import sys
from pathlib import Path

import pytest
from repository import ROOT
from rexs_unit import place, two_stages
from spur_case import spur_case

from lineofaction.gearbox.rexs.files import serialized

COMPUTING = ("numba", "gmsh", "skfem", "scipy.optimize", "scipy.interpolate", "xarray")
UNIT = "examples/two_stage_gearbox.rexs"


@pytest.mark.parametrize("name", COMPUTING)
def test_a_unit_without_catalog_bearings_is_opened_without(name, loaded):
    assert name not in loaded


@pytest.mark.parametrize("name", [name for name in COMPUTING if name != "scipy.optimize"])
def test_catalog_bearings_on_a_rigid_casing_are_opened_without(name, loaded_with_lines):
    assert name not in loaded_with_lines


@pytest.fixture(scope="module")
def loaded(tmp_path_factory):
    """Return what is loaded for the example, whose bearings have stiffnesses."""
    return modules_after(UNIT, tmp_path_factory.mktemp("unit"))


@pytest.fixture(scope="module")
def loaded_with_lines(tmp_path_factory):
    folder = tmp_path_factory.mktemp("lines")
    line = {"bearing_type": "radial_grooved_ball_bearing", "radial_static_load_rating": 11.6}
    line |= {"inner_diameter": 25.0, "outer_diameter": 62.0, "u_coordinate_on_shaft_inner_side": 15.0}
    bearing = ("rolling_bearing_with_catalog_geometry", line | place(15.0, 0.0, 0.0))
    unit = folder / "unit.rexs"
    unit.write_bytes(serialized(two_stages(more={31: bearing}), unit.name))
    loaded = modules_after(str(unit), folder / "opened")
    assert "[[rolling_bearings]]" in (folder / "opened" / "scene.toml").read_text("utf-8")
    return loaded


def modules_after(unit: str, out: Path) -> set[str]:
    """Return the names of the modules that ``loa open`` has loaded when it ends."""
    code = f"""
import sys
from pathlib import Path
from lineofaction.cli.open_unit import run_open
run_open(Path({unit!r}), Path({str(out)!r}), as_json=True)
print(*sys.modules, file=sys.stderr)
"""
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=120, cwd=ROOT
    )
    loaded = set(done.stderr.split())
    assert '"scene": true' in done.stdout and "lineofaction.gearbox.from_rexs.opened" in loaded
    return loaded


def test_computing_verbs_start_without_what_some_scenes_need():
    loaded = modules_of("import lineofaction.cli.analyze, lineofaction.cli.simulate")
    assert "dynamics.scene" in loaded
    unneeded = {"scipy.stats", "scipy.optimize", "scipy.interpolate", "scipy.spatial", "httpx2", "xarray"}
    assert not (unneeded | {"matplotlib"}) & loaded


def test_what_every_study_would_cost_is_said_without_statistics():
    """All studies are loaded for the state of a folder; draws, filters and tests only where they are made."""
    loaded = modules_of(
        "from lineofaction.gearbox.registry import STUDIES; [own.run for own in STUDIES.values()]"
    )
    assert "dynamics.orders.resampling" in loaded and "fe_contact.microgeometry.order_limit" in loaded
    assert not {"scipy.stats", "scipy.signal", "xarray"} & loaded


def test_the_state_of_a_folder_is_said_without_statistics(tmp_path):
    """What pairs within tolerances cost needs their number, no draw of them."""
    (tmp_path / "case.toml").write_text(spur_case(torques=[100.0]))
    code = "from lineofaction.cli.status import result_costs as costs, status_of"
    code += f"; from pathlib import Path; folder = Path({str(tmp_path)!r})"
    assert not {"scipy.stats", "scipy.signal"} & modules_of(f"{code}; costs(status_of(folder), folder)")


def modules_of(code: str) -> set[str]:
    """Return the names of the modules that are loaded once a process has run a line."""
    command = [sys.executable, "-c", f"{code}; import sys; print(*sys.modules)"]
    done = subprocess.run(command, capture_output=True, text=True, check=True, timeout=300)
    return set(done.stdout.split())
