"""A live answer of teeth that differ is what its schema declares, with the loads of each tooth."""

import json
from dataclasses import replace

import numpy as np
import pytest

from fe_contact import analyze
from lineofaction.gearbox.convert.case import case_json, gear_pair
from lineofaction.gearbox.convert.live import condensed_of, interpolated_columns, live_curves
from lineofaction.gearbox.schemas.case import Case
from lineofaction.gearbox.schemas.live import LiveInput
from lineofaction.gearbox.schemas.live_answer import LiveCurve
from lineofaction.gearbox.units import UM

EARLY = 4
CASE = {
    "pair": {
        "normal_module_mm": 1.0,
        "helix_angle_deg": 25.0,
        "center_distance_mm": 20.5,
        "pinion": {
            "teeth": 17,
            "face_width_mm": 8.0,
            "bore_diameter_mm": 8.0,
            "pitch_deviation_um": [2.0 if tooth == EARLY else 0.0 for tooth in range(1, 18)],
        },
        "wheel": {"teeth": 20, "face_width_mm": 8.0, "bore_diameter_mm": 8.0},
    },
    "load": {"torque_n_m": [2.0]},
}


@pytest.mark.parametrize("count", [1, 2, 40])
def test_columns_of_a_passage_are_interpolated_as_each_by_itself(count):
    random = np.random.default_rng(3)
    knots = np.sort(random.uniform(0.0, 1.0, count))
    values = random.normal(size=(count, 7))
    x = np.concatenate([random.uniform(-0.2, 1.2, 200), knots])
    single = np.column_stack([np.interp(x, knots, column) for column in values.T])
    np.testing.assert_array_max_ulp(interpolated_columns(x, knots, values), single, 0)


@pytest.mark.usefixtures("coarse_sectors")
def test_a_live_answer_names_the_tooth_that_is_early(tmp_path):
    case = Case.model_validate_json(json.dumps(CASE))
    table = analyze(
        gear_pair(case), torques=[2.0], level="draft", positions=8, receipt="minimal", cache=tmp_path
    )
    echoed = json.loads(json.dumps(case_json(case)))
    file = tmp_path / "table.nc"
    replace(table, metadata=replace(table.metadata, case=echoed)).to_netcdf(file)
    answer = live_curves(condensed_of(file, tmp_path), LiveInput(torque_n_m=(2.0,)))
    curve = LiveCurve.model_validate_json(json.dumps(answer["curves"][0]))
    assert curve.period == 17 and curve.order_name is not None and curve.order_name[0] == "pinion 1"
    assert curve.tooth_loads is not None and list(curve.tooth_loads) == ["pinion"]
    assert curve.tooth_loads["pinion"].most_loaded == [EARLY]


@pytest.mark.usefixtures("coarse_sectors")
def test_an_answer_at_a_load_of_the_table_states_the_numbers_of_the_table(tmp_path):
    gear = {"teeth": 20, "face_width_mm": 4.0, "bore_diameter_mm": 10.0}
    content = {
        "pair": {"normal_module_mm": 1.0, "center_distance_mm": 20.0, "pinion": gear, "wheel": gear},
        "load": {"torque_n_m": [0.5, 1.0]},
    }
    case = Case.model_validate_json(json.dumps(content))
    table = analyze(
        gear_pair(case), torques=[0.5, 1.0], level="draft", model="plane_strain", positions=16, cache=tmp_path
    )
    table = replace(table, metadata=replace(table.metadata, case=json.loads(json.dumps(case_json(case)))))
    file = tmp_path / "table.nc"
    table.to_netcdf(file)
    condensed = condensed_of(file, tmp_path)
    (stored, between), (moved,) = (
        live_curves(condensed, LiveInput.model_validate(question))["curves"]
        for question in (
            {"torque_n_m": (0.5, 0.7), "flanks": True},
            {"torque_n_m": (0.5,), "pinion": {"tip_relief_um": 0.01, "tip_relief_length_mm": 0.3}},
        )
    )
    of_table = table.curve(torque=0.5)
    for estimate, name in ((of_table.mean, "mean"), (of_table.peak_to_peak, "peak_to_peak")):
        assert stored[f"{name}_um"] == estimate.value / UM
        assert stored[f"{name}_error_um"] == pytest.approx(1e6 * estimate.error, rel=1e-12)
        by_source = [errors[name] for errors in stored["error_by_source_um"].values()]
        assert stored[f"{name}_error_um"] == pytest.approx(np.linalg.norm(by_source), rel=1e-9)
    pressure = stored["flanks"]["largest_pressure_mpa"]
    assert pressure == pytest.approx(1e-6 * np.nanmax(table.max_pressure[:, 0]), rel=1e-12)
    assert len(stored["position"]) == len(moved["position"]) > of_table.position.size
    ripple = table.curve(torque=0.7).peak_to_peak
    for solved, known in ((between, ripple), (moved, of_table.peak_to_peak)):
        difference = abs(solved["peak_to_peak_um"] - 1e6 * known.value)
        assert 0.0 < difference < solved["peak_to_peak_error_um"] + 1e6 * known.error, "solved anew"


@pytest.mark.usefixtures("coarse_sectors")
def test_an_answer_does_not_lend_its_error_to_a_table_without_errors(tmp_path):
    """Sixteen positions miss 5 % of the ripple of a short relief, and a minimal receipt does not say it."""
    gear = {"teeth": 20, "face_width_mm": 4.0, "bore_diameter_mm": 10.0}
    relieved = gear | {"tip_relief_um": 8.0, "tip_relief_length_mm": 0.4}
    pair = {"normal_module_mm": 1.0, "center_distance_mm": 20.0, "pinion": relieved, "wheel": gear}
    case = Case.model_validate_json(json.dumps({"pair": pair, "load": {"torque_n_m": [0.5, 1.0]}}))
    options = {"torques": [0.5, 1.0], "level": "draft", "model": "plane_strain", "cache": tmp_path}
    coarse = analyze(gear_pair(case), positions=16, receipt="minimal", **options)
    coarse = replace(coarse, metadata=replace(coarse.metadata, case=json.loads(json.dumps(case_json(case)))))
    file = tmp_path / "table.nc"
    coarse.to_netcdf(file)
    (answer,) = live_curves(condensed_of(file, tmp_path), LiveInput(torque_n_m=(1.0,)))["curves"]
    fine = analyze(gear_pair(case), positions=256, receipt="minimal", **options)
    truth, stored = (1e6 * table.curve(torque=1.0).peak_to_peak.value for table in (fine, coarse))
    off = abs(stored - truth)
    assert answer["peak_to_peak_um"] == pytest.approx(stored, rel=1e-12), "a report states it too"
    assert 0.02 * truth < off < answer["peak_to_peak_error_um"] < 2.0 * off
    by_source = [errors["peak_to_peak"] for errors in answer["error_by_source_um"].values()]
    assert answer["peak_to_peak_error_um"] == pytest.approx(np.linalg.norm(by_source), rel=1e-9)
    assert len(answer["error_um"]) == len(answer["ste_um"])
