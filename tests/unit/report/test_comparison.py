"""Laws of comparisons, of measurements too: what is equal is not shown to differ, what moved is found."""

import math
import warnings
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from geared_scenes import RPM, gear_pair_scene

from dynamics import TimeLaw, simulate
from dynamics.export import write_universal_file
from fe_contact import Estimate
from lineofaction.gearbox.problems import BadInput
from lineofaction.report.comparison.compare import compare, compare_runs
from lineofaction.report.comparison.measured import (
    PER_PITCH,
    Difference,
    MeasuredCurve,
    MeasuredOrders,
    aligned_to,
    averaged,
    read_measured,
)
from lineofaction.report.comparison.of_tables import compare_tables
from lineofaction.report.comparison.universal_files import read_universal
from lineofaction.report.document import read_result
from lineofaction.report.run.view import RunView

X = np.arange(PER_PITCH) / PER_PITCH
RIPPLE = np.cos(2 * np.pi * X) + 0.4 * np.cos(4 * np.pi * X + 1.0)
TEETH = 23


def difference(first: float, second: float, errors: tuple[float, float]) -> Difference:
    pair = (Estimate(value, error, "µm") for value, error in zip((first, second), errors, strict=True))
    return Difference("peak to peak", "100 N m", *pair)


def written(path: Path, names: str, columns: np.ndarray) -> Path:
    np.savetxt(path, columns, delimiter=",", header=names, comments="")
    return path


def rows(page, title: str) -> list[tuple[str, ...]]:
    tables = [table for section in page.sections for table in section.tables if table.caption == title]
    return [row for table in tables for row in table.rows]


def test_a_difference_within_its_error_is_not_shown():
    one = difference(1.0, 1.1, (0.05, 0.12))
    assert one.error == pytest.approx(0.13)
    assert str(one) == "+0.10 ± 0.13 µm: not shown to differ"
    assert one.between == "1.00 to 1.10 µm, by +0.10 ± 0.13"
    assert str(difference(1.0, 1.2, (0.05, 0.12))) == "+0.20 ± 0.13 µm: the second is larger"
    assert difference(1.0, 0.8, (0.05, 0.12)).finding == "the second is smaller"
    assert difference(1.0, 9.0, (math.nan, 0.1)).finding == "no error stated"


def test_a_table_is_not_shown_to_differ_from_itself(database):
    page = compare_tables({"a": database, "b": database}, None)
    found = rows(page, "Differences with their errors")
    assert found and {row[-1] for row in found} == {"not shown to differ"}
    assert [section.title for section in page.sections] == ["Transmission errors"]


def test_a_table_of_twice_the_error_is_shown_to_differ_with_the_field_that_does_it(database):
    twice = replace(
        database,
        static_transmission_error=2.0 * database.static_transmission_error,
        tangent_compliance=2.0 * database.tangent_compliance,
    )
    first, second = (
        replace(table, metadata=replace(table.metadata, case={"pair": {"normal_module_mm": module}}))
        for table, module in ((database, 4.0), (twice, 2.0))
    )
    page = compare_tables({"a": first, "b": second}, None, torque=100.0)
    peak = next(row for row in rows(page, "Differences with their errors") if row[0] == "peak to peak")
    assert peak[-1] == "the second is larger"
    assert rows(page, "Fields that differ") == [("pair.normal_module_mm", "4", "2")]


def test_torques_that_only_one_table_holds_are_refused(database):
    with pytest.raises(BadInput, match="--torque"):
        compare_tables({"a": database, "b": database}, None, torque=1e4)


@pytest.mark.parametrize("shift", [0, 31, 200])
def test_a_moved_ripple_is_moved_back(shift):
    measured = MeasuredCurve(np.roll(RIPPLE, -shift), 0.0, 1)
    found = aligned_to(measured, RIPPLE + 12.0)
    assert found.shift == shift / PER_PITCH
    assert found.rms < 1e-12
    assert found.correlation == pytest.approx(1.0)


@pytest.mark.parametrize(("name", "scale"), [("position", 1.0), ("angle_deg", 360.0 / TEETH)])
def test_a_measured_curve_is_averaged_over_its_base_pitches(name, scale, tmp_path):
    """Run-out averages out over a revolution; samples that do not divide the pitch are no matter."""
    position = np.arange(0.0, TEETH + 0.2, 1.0 / 177.3) + 0.31
    runout = 3.0 * np.sin(2 * np.pi * position / TEETH)
    values = 40.0 + np.interp(position % 1.0, np.append(X, 1.0), np.append(RIPPLE, RIPPLE[0])) + runout
    file = written(
        tmp_path / "m.csv", f"{name},transmission_error_um", np.stack([position * scale, values], axis=1)
    )
    found = read_measured(file, TEETH)
    assert found.pitches == TEETH
    np.testing.assert_allclose(found.ripple, RIPPLE, atol=0.02)
    assert found.spread > 0.1


def test_shaft_orders_become_mesh_orders(tmp_path):
    file = written(tmp_path / "o.csv", "order,amplitude_n", np.array([[1.0, 5.0], [23.0, 7.0], [46.4, 2.0]]))
    found = read_measured(file, TEETH)
    assert (found.near(1.0), found.near(2.0), found.unit) == (7.0, 2.0, "N")
    assert math.isnan(found.near(3.0))
    with pytest.raises(BadInput, match="amplitudes in µm"):
        found.require("µm")


@pytest.mark.parametrize(
    "text",
    ["", "a,b\n1,2\n", "position,amplitude_n\n0,1\n1,2\n", "position,transmission_error_um\n0,x\n",
     "position,transmission_error_um\n0,1\n0.5,2\n", "order,amplitude_um\n1,nan\n"],
)  # fmt: skip
def test_what_is_no_measurement_is_refused(text, tmp_path):
    (tmp_path / "m.csv").write_text(text)
    with pytest.raises(BadInput, match="measured"):
        read_measured(tmp_path / "m.csv", TEETH)


def test_a_run_of_twice_the_force_is_6_db_louder(run):
    twice = replace(run, bearing_force=2.0 * run.bearing_force)
    page = compare_runs({"a": run, "b": twice}, RunView(), None)
    assert "changes by +6.0 dB" in page.sections[0].figures[0].alternative
    found = {row[0]: row for row in rows(page, "Differences with their errors")}
    assert found["mesh order 2"][-1] == "no error stated"  # the receipt of this run has none of orders


def test_stated_errors_of_orders_decide(run):
    receipt = {**run.receipt, "error": {"time_step": {"bearing_force_orders": [0.1, 30.0]}}}
    stated = replace(run, receipt=receipt)
    louder = replace(stated, bearing_force=1.5 * run.bearing_force)
    page = compare_runs({"a": stated, "b": louder}, RunView(scale="peak"), None)
    found = {row[0]: row for row in rows(page, "Differences with their errors")}
    assert found["mesh order 1"][-1] == "the second is larger"  # 5 N, 0.14 N
    assert found["mesh order 2"][-1] == "not shown to differ"  # 10 N, 42 N
    assert page.headlines[1].value == "10.0 to 15.0 N peak, by +5.00 ± 0.14"


def test_files_are_compared_by_what_they_hold(database, run, tmp_path):
    database.to_netcdf(tmp_path / "ste.nc")
    run.to_netcdf(tmp_path / "run.nc")
    measured = written(
        tmp_path / "m.csv",
        "position,transmission_error_um",
        np.stack([4 * X, np.tile(RIPPLE[::4], 4)], axis=1),
    )
    ste, motion = tmp_path / "ste.nc", tmp_path / "run.nc"
    page = compare([ste, measured], RunView())
    assert [line.name for line in page.sections[0].figures[0].content[0].lines] == ["ste", "measured"]
    for files in ([ste], [ste, motion], [measured], [ste, ste, ste], [motion, measured]):
        with pytest.raises(BadInput):
            compare(files, RunView())


def test_of_two_folders_what_both_have_by_name_is_compared(database, run, tmp_path):
    before, after = tmp_path / "before", tmp_path / "after"
    for folder in (before, after):
        folder.mkdir()
        database.to_netcdf(folder / "first_stage.nc")
        run.to_netcdf(folder / "run.nc")
    database.to_netcdf(before / "second_stage.nc")
    louder = replace(run, bearing_force=2.0 * run.bearing_force)
    louder.to_netcdf(after / "run.nc")
    page = compare([before, after], RunView())
    assert page.title == "before and after compared"
    assert page.lead.endswith("in one folder alone: second_stage")
    said = {line.name: line.remark for line in page.headlines}
    assert said["peak to peak at 100 N m, first stage"] == "not shown to differ"
    assert "overall, run" in said
    alone = compare([before / "run.nc", after / "run.nc"], RunView())
    assert [line.value for line in alone.headlines] == [
        line.value for line in page.headlines if line.name.endswith(", run")
    ]
    (after / "first_stage.nc").rename(after / "stage.nc")
    (after / "run.nc").unlink()
    with pytest.raises(
        BadInput, match=r"before has first_stage, run, second_stage; after has stage.*one name"
    ):
        compare([before, after], RunView())
    for files in ([before], [before, after / "stage.nc"], [before, before, after]):
        with pytest.raises(BadInput, match=r"two folders.*Of a folder name the file: .*first_stage\.nc"):
            compare(files, RunView())
    with pytest.raises(BadInput, match="It is a folder"):
        read_result(before)


with warnings.catch_warnings():
    warnings.simplefilter("ignore")
    import pyuff
PITCHES = np.arange(4 * PER_PITCH) / PER_PITCH
MEASURED = 0.8 * np.cos(2 * np.pi * PITCHES) + 0.2 * np.sin(4 * np.pi * PITCHES)


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


def universal(file: Path, *functions: dict[str, Any], length: float = 1.0) -> Path:
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
def test_a_transmission_error_is_what_csv_would_say(label, scale, length, tmp_path):
    file = universal(
        tmp_path / "m.uff", function(label, PITCHES * scale, 1e-6 * length * MEASURED), length=length
    )
    found, known = read_universal(file, TEETH, "µm"), averaged(file, PITCHES, MEASURED)
    assert found.pitches == known.pitches
    np.testing.assert_allclose(found.ripple, known.ripple, atol=2e-4)


def test_orders_of_the_shaft_become_mesh_orders(tmp_path):
    x = np.arange(0.0, 50.0)
    own: dict[str, Any] = {"abscissa_spec_data_type": 20, "ordinate_spec_data_type": 12}
    file = universal(tmp_path / "o.unv", function("Order", x, 1e3 * x, **own), length=1e3)
    found = read_universal(file, TEETH, "m/s²")
    assert isinstance(found, MeasuredOrders) and found.unit == "m/s²"
    np.testing.assert_allclose(found.order * TEETH, x, atol=1e-6)
    np.testing.assert_allclose(found.amplitude, x, rtol=1e-6)


def test_what_this_program_writes_is_read_back(tmp_path):
    run = simulate(gear_pair_scene(speed=TimeLaw.ramp(0.0, 955.0 * RPM, 0.2), duration=0.2))
    file = tmp_path / "run.unv"
    write_universal_file(run, file, "orders")
    found = read_universal(file, TEETH, "µm")
    assert found.near(1.0) > 0.0
    (kept,) = (each for each in pyuff.UFF(str(file)).read_sets() if each.get("ordinate_spec_data_type") == 8)
    np.testing.assert_allclose(found.amplitude, 1e6 * np.abs(kept["data"]), rtol=1e-12)
    np.testing.assert_allclose(found.order, kept["x"])  # mesh orders, not those of a shaft


def test_one_of_several_is_not_guessed(tmp_path):
    one, other = (
        function("Position", PITCHES, MEASURED),
        function("Position", PITCHES, MEASURED, id1="second"),
    )
    with pytest.raises(BadInput, match=r"2 in m\.uff: Position, second"):
        read_universal(universal(tmp_path / "m.uff", one, other), TEETH, "µm")
    with pytest.raises(BadInput, match="0 in time"):
        read_universal(universal(tmp_path / "time.uff", function("Time", PITCHES, MEASURED)), TEETH, "µm")
    (tmp_path / "bad.uff").write_text("no universal file")
    with pytest.raises(BadInput, match="measured"):
        read_universal(tmp_path / "bad.uff", TEETH, "µm")


def test_a_table_is_compared_with_one(database, tmp_path):
    database.to_netcdf(tmp_path / "ste.nc")
    measured = universal(tmp_path / "m.uff", function("Position", PITCHES, 1e-6 * MEASURED))
    page = compare([tmp_path / "ste.nc", measured], RunView())
    assert [line.name for line in page.sections[0].figures[0].content[0].lines] == ["ste", "measured"]
