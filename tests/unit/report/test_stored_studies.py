"""Studies kept as netCDF files: the same figures and the same page as fresh ones."""

import json
from dataclasses import field, fields, make_dataclass, replace
from typing import Any, get_type_hints

import h5netcdf
import numpy as np
import pytest
from analysis_requests import design_request, table_request
from geared_scenes import gear_pair_scene

from dynamics.ablation import ablate as ablate_scene
from dynamics.accuracy import FidelityResult as SceneFidelity
from dynamics.accuracy import Frontier as SceneFrontier
from fe_contact.analysis.studies.ablation import ablate
from fe_contact.geometry import FlankModification, Gear, GearPair
from fe_contact.microgeometry.confirmation import HarrisMap
from fe_contact.microgeometry.optimization import Optimization
from fe_contact.microgeometry.optimize import optimize
from fe_contact.microgeometry.scatter import GaussHermite, Scatter
from fe_contact.microgeometry.search import Search
from fe_contact.microgeometry.tolerance_study import Sampling, scatter
from fe_contact.microgeometry.tolerances import iso1328_tolerances
from fe_contact.microgeometry.variables import DesignVariable
from fe_contact.options import AnalysisOptions, Run
from fe_contact.types import FloatArray
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.registry import STUDIES
from lineofaction.gearbox.schemas.plan import InputWarning
from lineofaction.report.design.optimize import _ripple_table
from lineofaction.report.document import page_json, page_of, read_inputs, stored_figures
from lineofaction.report.effects.ablate import PAGE
from lineofaction.report.presentation import presentation_of
from lineofaction.report.ste.curves import MAX_CURVES
from model_studies.record_file import write_record

RELIEF = FlankModification(tip_relief=15e-6, tip_relief_length=1.2e-3)
GEAR = Gear(20, 4e-3, 0.025, 0.04, modification=RELIEF)
PAIR = GearPair(GEAR, GEAR, 0.08)
QUICK: dict[str, Any] = {"level": "draft", "model": "plane_strain"}


@pytest.fixture(scope="module")
def compliance(tmp_path_factory):
    return tmp_path_factory.mktemp("compliance")


@pytest.fixture(scope="module")
def studies(compliance):
    only = ["tooth_coupling", "profile_modification", "misalignment"]
    of_case = ablate(
        PAIR,
        *table_request(torques=[20.0, 100.0], positions=16, **QUICK),
        run=Run(cache=compliance),
        only=only,
    )
    of_scene = ablate_scene(gear_pair_scene(duration=0.03), only=["lateral"])
    variables = [
        DesignVariable("pinion.tip_relief", 0.0, 40e-6),
        DesignVariable("wheel.tip_relief_length", 5e-4, 3e-3),
    ]
    slopes = Scatter(modification={"wheel.profile_slope": 2e-6}, rule=GaussHermite(2))
    found, exact = (
        optimize(
            design_request(
                PAIR, [50.0, 100.0], variables, scatter, search=Search(evaluations=20, positions=16), **QUICK
            ),
            Run(cache=compliance),
        )
        for scatter in (slopes, Scatter())
    )
    tolerances = iso1328_tolerances(PAIR, 8, across_face=False)
    drawn = scatter(
        PAIR,
        [50.0, 100.0],
        tolerances,
        Sampling(samples=30, positions=16),
        AnalysisOptions(**QUICK),
        Run(cache=compliance),
    )
    told = (("rigid", "model", 0.2, 0.1), ("coarse", "steps", 0.01, 1.0), ("fine", "steps", 1e-4, 9.0))
    rungs = tuple(
        SceneFidelity(name, name, seconds, family, error, 2.0 * error)
        for name, family, error, seconds in told
    )
    ladder = SceneFrontier(rungs, {"modes": "no bearings"}, "coarse", None, 5, 3, np.ones((3, 1)))
    results = {
        "ablation of a case": ("ablate", of_case),
        "ablation of a scene": ("ablate", of_scene),
        "accuracy study of a scene": ("frontier", ladder),
        "optimization": ("optimize", found),
        "optimization without scatter": ("optimize", exact),
        "tolerances": ("scatter", drawn),
    }
    return {name: (STUDIES[study], result) for name, (study, result) in results.items()}


ALL = (
    "ablation of a case",
    "ablation of a scene",
    "accuracy study of a scene",
    "optimization",
    "optimization without scatter",
    "tolerances",
)


def test_an_optimization_of_one_misalignment_for_all_torques_still_opens(studies, tmp_path):
    """As version 0.2 wrote it."""
    study, result = studies["optimization"]
    hints = get_type_hints(Optimization) | {"misalignment": float}
    metadata = {each.name: dict(each.metadata) for each in fields(Optimization)}
    metadata["misalignment"].pop("dimensions")
    before = make_dataclass(
        "Optimization", [(name, hints[name], field(metadata=facts)) for name, facts in metadata.items()]
    )
    values = {name: getattr(result, name) for name in metadata} | {"misalignment": 5e-6}
    write_record(before(**values), tmp_path / "before.nc", "lineofaction optimization")
    opened = study.run.file.read(tmp_path / "before.nc")
    assert opened.misalignment.tolist() == [5e-6, 5e-6]
    assert opened.optimum.objective == result.optimum.objective
    assert study.run.figures(opened)["misalignment_um"] == pytest.approx([5.0, 5.0], rel=1e-12)
    assert {row[1] for row in _ripple_table(opened).rows} == {"5.00"}


@pytest.mark.parametrize("name", ALL)
def test_its_file_says_and_draws_what_the_fresh_one_does(studies, name, tmp_path):
    study, result = studies[name]
    file = tmp_path / "study.nc"
    study.run.file.write(result, file)
    fresh = json.dumps(study.run.figures(result), allow_nan=False)
    assert json.dumps(study.run.figures(study.run.file.read(file)), allow_nan=False) == fresh
    told = stored_figures({"kind": study.kind, "file": str(file)})
    assert told == page_json(presentation_of(study).page(result))
    assert all(f["alternative"] and f["plot"]["data"] for s in told["sections"] for f in s["figures"])
    assert page_json(page_of(read_inputs([file]))) == told, "a report and the service show the same"


def test_both_harris_maps_are_drawn_to_one_scale(studies):
    """A curve's height is its ripple, and the torques stand apart by the same on both."""
    study, result = studies["optimization"]
    content = study.run.figures(result)
    (figure,) = (
        f for s in presentation_of(study).page(result).sections for f in s.figures if f.key == "harris_map"
    )
    before, after, _ = figure.content
    assert before.y.limits == after.y.limits
    for panel, name in ((before, "start"), (after, "optimum")):
        told = content[name]["harris_map"]
        for line in panel.lines:
            torque = float(line.name.removesuffix(" N m"))
            ripple = told["nominal_peak_to_peak_um"][told["torque_n_m"].index(torque)]
            assert np.ptp(line.y) == pytest.approx(ripple, rel=1e-6)
            assert line.label == line.name
        levels = [float(line.y[:-1].mean()) for line in panel.lines]
        assert np.ptp(np.diff(levels)) < 1e-9 * levels[-1]


def test_torques_that_count_and_those_that_get_worse_are_drawn(studies):
    study, result = studies["optimization"]
    torque = np.sort([*np.arange(31.0, 132.0, 2.0), *result.torque])
    start, optimum = (at_torques(design.harris_map, torque) for design in [result.start] * 2)
    optimum.peak_to_peak[:, 3] = start.peak_to_peak[:, 3] + 1e-6
    wide = replace(
        result,
        start=replace(result.start, harris_map=start),
        optimum=replace(result.optimum, harris_map=optimum),
    )
    (figure,) = (
        f for s in presentation_of(study).page(wide).sections for f in s.figures if f.key == "harris_map"
    )
    expected = {37.0, *result.torque.tolist()}
    for panel in figure.content[:2]:
        drawn = {float(line.name.removesuffix(" N m")) for line in panel.lines}
        assert expected <= drawn and len(panel.lines) <= MAX_CURVES
    (warning,) = study.run.warnings(wide) or ()
    assert warning["check"] == "worse_load" and "rises at 37 N m" in warning["message"]
    assert InputWarning.model_validate(warning).value == pytest.approx(optimum.expected[3] * 1e6)


def at_torques(harris: HarrisMap, torque: FloatArray) -> HarrisMap:
    """Return a map at other torques, all of the ripple of the first; known exactly."""
    many, first = torque.size, np.zeros(torque.size, dtype=int)
    ripple = harris.peak_to_peak[:, first].copy()
    return HarrisMap(
        torque, harris.position, harris.ste[:, first], harris.nominal[first], np.zeros(many), ripple,
        np.zeros_like(ripple), harris.weight,
    )  # fmt: skip


def test_a_report_takes_a_study_beside_a_table(studies, database, tmp_path):
    table, file = tmp_path / "ste.nc", tmp_path / "optimum.nc"
    database.to_netcdf(table)
    study, result = studies["optimization"]
    study.run.file.write(result, file)
    keys = [f.key for s in page_of(read_inputs([file, table])).sections for f in s.figures]
    assert keys.index("ste") < keys.index("harris_map")
    with pytest.raises(BadInput, match="the only optimization"):
        read_inputs([file, file])


def test_json_and_a_damaged_file_are_refused_with_a_reason(studies, tmp_path):
    study, result = studies["tolerances"]
    old, file = tmp_path / "scatter.json", tmp_path / "scatter.nc"
    study.run.save_figures(result, old)
    with pytest.raises(BadInput, match=r"JSON is for programs.*-o FILE\.nc"):
        read_inputs([old])
    study.run.file.write(result, file)
    with h5netcdf.File(file, "r+") as content:
        content.variables["nominal"][...] = 0.0
    with pytest.raises(BadInput, match="undamaged scatter"):
        read_inputs([file])


def test_an_ablation_of_nothing_has_its_reasons_and_no_plot(compliance):
    none = ablate(
        PAIR,
        *table_request(torques=[20.0], positions=16, **QUICK),
        run=Run(cache=compliance),
        only=["misalignment"],
    )
    (section,) = PAGE.page(none).sections
    assert not section.figures
    assert section.tables[-1].rows == (("misalignment", "the gears are aligned"),)
