"""Measurements in universal files: those of this program and of pyuff, in the units of the file."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from geared_scenes import RPM, gear_pair_scene

from dynamics.export import write_universal_file
from dynamics.loads import TimeLaw
from dynamics.simulation import simulate
from fe_contact.ste import SteDatabase
from lineofaction.gearbox.problems import BadInput
from lineofaction.report.comparison.compare import _read_universal, compare
from lineofaction.report.comparison.measured import PER_PITCH, MeasuredCurve, MeasuredOrders, averaged
from lineofaction.report.run.view import RunView

with warnings.catch_warnings():
    warnings.simplefilter("ignore")
    import pyuff

TEETH = 23
X = np.arange(4 * PER_PITCH) / PER_PITCH
RIPPLE = 0.8 * np.cos(2 * np.pi * X) + 0.2 * np.sin(4 * np.pi * X)


def function(label: str, x: Any, values: Any, **changes: Any) -> dict[str, Any]:
    """Return a dataset 58: by default a displacement over something."""
    step = float(x[1] - x[0])
    facts = {
        "func_type": 1, "rsp_node": 1, "rsp_dir": 0, "ref_node": 0, "ref_dir": 0, "data": values, "x": x,
        "id1": label, "abscissa_spec_data_type": 1, "abscissa_axis_lab": label, "ordinate_spec_data_type": 8,
        "abscissa_min": float(x[0]), "abscissa_inc": step, "num_pts": len(x), "abscissa_spacing": 1,
        "orddenom_spec_data_type": 0, "z_axis_axis_lab": "NONE", "ver_num": 0, "load_case_id": 0,
        "rsp_ent_name": "NONE", "ref_ent_name": "NONE", "binary": 0,
    }  # fmt: skip
    blank = {name: value or 0 for name, value in pyuff.prepare_58(return_full_dict=True).items()}
    texts = {name: "NONE" for name in blank if name.endswith("_lab") or name.startswith("id")}
    return {**blank, **texts, "type": 58, **facts, **changes}


def written(file: Path, *functions: dict[str, Any], length: float = 1.0) -> Path:
    units = pyuff.prepare_164(
        units_code=9,
        units_description="own",
        temp_mode=1,
        length=length,
        force=1.0,
        temp=1.0,
        temp_offset=0.0,
    )
    pyuff.UFF(str(file)).write_sets([units, *functions], mode="overwrite")
    return file


@pytest.mark.parametrize("length", [1.0, 1e3])
@pytest.mark.parametrize(("label", "scale"), [("Position", 1.0), ("Angle", 360.0 / TEETH)])
def test_a_transmission_error_is_what_csv_would_say(
    label: str, scale: float, length: float, tmp_path: Path
) -> None:
    file = written(tmp_path / "m.uff", function(label, X * scale, 1e-6 * length * RIPPLE), length=length)
    found, known = _read_universal(file, TEETH, "µm"), averaged(file, X, RIPPLE)
    assert isinstance(found, MeasuredCurve)
    assert found.pitches == known.pitches
    np.testing.assert_allclose(found.ripple, known.ripple, atol=2e-4)


def test_orders_of_the_shaft_become_mesh_orders(tmp_path: Path) -> None:
    x = np.arange(0.0, 50.0)
    own: dict[str, Any] = {"abscissa_spec_data_type": 20, "ordinate_spec_data_type": 12}
    file = written(tmp_path / "o.unv", function("Order", x, 1e3 * x, **own), length=1e3)
    found = _read_universal(file, TEETH, "m/s²")
    assert isinstance(found, MeasuredOrders) and found.unit == "m/s²"
    np.testing.assert_allclose(found.order * TEETH, x, atol=1e-6)
    np.testing.assert_allclose(found.amplitude, x, rtol=1e-6)


def test_what_this_program_writes_is_read_back(tmp_path: Path) -> None:
    run = simulate(gear_pair_scene(speed=TimeLaw.ramp(0.0, 955.0 * RPM, 0.2), duration=0.2))
    file = tmp_path / "run.unv"
    write_universal_file(run, file, "orders")
    found = _read_universal(file, TEETH, "µm")
    assert isinstance(found, MeasuredOrders)
    assert found.near(1.0) > 0.0
    (kept,) = (each for each in pyuff.UFF(str(file)).read_sets() if each.get("ordinate_spec_data_type") == 8)
    np.testing.assert_allclose(found.amplitude, 1e6 * np.abs(kept["data"]), rtol=1e-12)
    np.testing.assert_allclose(found.order, kept["x"])  # mesh orders, not those of a shaft


def test_one_of_several_is_not_guessed(tmp_path: Path) -> None:
    one, other = function("Position", X, RIPPLE), function("Position", X, RIPPLE, id1="second")
    with pytest.raises(BadInput, match=r"2 in m\.uff: Position, second"):
        _read_universal(written(tmp_path / "m.uff", one, other), TEETH, "µm")
    with pytest.raises(BadInput, match="0 in time"):
        _read_universal(written(tmp_path / "time.uff", function("Time", X, RIPPLE)), TEETH, "µm")
    (tmp_path / "bad.uff").write_text("no universal file")
    with pytest.raises(BadInput, match="measured"):
        _read_universal(tmp_path / "bad.uff", TEETH, "µm")


def test_a_table_is_compared_with_one(database: SteDatabase, tmp_path: Path) -> None:
    database.to_netcdf(tmp_path / "ste.nc")
    measured = written(tmp_path / "m.uff", function("Position", X, 1e-6 * RIPPLE))
    page = compare([tmp_path / "ste.nc", measured], RunView())
    assert [line.name for line in page.sections[0].figures[0].content[0].lines] == ["ste", "measured"]
