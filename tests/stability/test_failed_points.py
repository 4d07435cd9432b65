"""One damaged position: its points are marked and say why, the rest stands as if nothing were."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

import fe_contact.analysis.pairs.pair_contact as room
from fe_contact import Gear, GearPair, SteDatabase, analyze, flank_results
from fe_contact.contact import ContactProblem, ContactSolution, Start, solve_contact
from fe_contact.errors import SolveError
from fe_contact.options import AnalysisOptions, OperatingPoint
from fe_contact.types import FloatArray, Status

GEAR = Gear(teeth=20, normal_module=4e-3, face_width=25e-3, bore_diameter=40e-3)
PAIR = GearPair(GEAR, GEAR, 80e-3)
TORQUES = [10.0, 50.0, 100.0]
DAMAGED = 0.25


def damaging(problem: ContactProblem, load: FloatArray, start: Start | None = None) -> ContactSolution:
    """Solve with a compliance that is no longer definite at one position."""
    compliance = problem.compliance.copy()
    hit = np.flatnonzero(problem.candidates.position == DAMAGED)
    compliance[hit] *= -1.0
    return solve_contact(replace(problem, compliance=compliance), load, start)


def table(**how: object) -> SteDatabase:
    return analyze(PAIR, torques=TORQUES, model="plane_strain", level="draft", **how)


@pytest.fixture(scope="module", params=[{"positions": 32}, {"positions": 32, "receipt": "minimal"}, {}])
def both(request) -> tuple[SteDatabase, SteDatabase]:
    """The table as it should be, and the damaged one."""
    sound = table(**request.param)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(room, "solve_contact", damaging)
        return sound, table(**request.param)


def test_the_failed_points_are_marked_and_nothing_else(both) -> None:
    _, damaged = both
    at = damaged.position == DAMAGED
    assert at.sum() == 1
    assert np.all(damaged.status[at] == Status.SINGULAR)
    assert np.all(damaged.status[~at] == Status.CONVERGED)
    for name in ("static_transmission_error", "tangent_compliance", "max_pressure"):
        assert np.all(np.isnan(getattr(damaged, name)[at])), name
        assert np.all(np.isfinite(getattr(damaged, name)[~at])), name


def test_the_rest_of_the_table_is_what_it_would_have_been(both) -> None:
    sound, damaged = both
    common = np.intersect1d(sound.position, damaged.position[damaged.position != DAMAGED])
    assert common.size >= 31
    for name in ("static_transmission_error", "load_share", "no_load_transmission_error", "residuals"):
        these, those = (getattr(t, name)[np.isin(t.position, common)] for t in (sound, damaged))
        np.testing.assert_array_equal(these, those, err_msg=name)


def test_the_table_says_which_failed_and_why(both) -> None:
    sound, damaged = both
    assert "3 of" in damaged.summary() and "position 0.25" in damaged.summary()
    assert "SINGULAR" in damaged.summary()
    assert damaged.metadata.receipt["failed_points"] == {"SINGULAR": len(TORQUES)}
    assessed = "error estimate" in damaged.metadata.receipt["stages"]
    assert (damaged.metadata.receipt["condition_number_max"] is not None) == assessed
    assert sound.metadata.receipt["failed_points"] == {}
    json.dumps(damaged.metadata.receipt, allow_nan=False)


def test_it_answers_from_the_rows_that_are_complete_and_only_if_asked(both, tmp_path) -> None:
    sound, damaged = both
    with pytest.raises(SolveError, match="SINGULAR"):
        damaged.curve(torque=100.0)
    curve = damaged.curve(torque=100.0, allow_failed=True)
    assert curve.mean.value == pytest.approx(sound.mean(torque=100.0).value, rel=0.01)
    damaged.to_netcdf(tmp_path / "ste.nc")
    assert SteDatabase.from_netcdf(tmp_path / "ste.nc").identical(damaged)


def test_support_loads_that_fail_are_left_out_and_named(both) -> None:
    sound, damaged = both
    assert sound.support_force.size > 0
    assert sound.metadata.receipt["support_loads_left_out"] == []
    assert damaged.support_force.size == 0
    assert len(damaged.metadata.receipt["support_loads_left_out"]) == sound.support_force.size


def test_flank_results_say_which_position_failed_and_why() -> None:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(room, "solve_contact", damaging)
        said = r"1 of 64 positions have no solution \(position 0.25: SINGULAR\)"
        with pytest.raises(SolveError, match=said) as error:
            flank_results(
                PAIR, OperatingPoint(torque=100.0), AnalysisOptions(model="plane_strain", level="draft")
            )
    assert isinstance(error.value.partial, ContactSolution)
