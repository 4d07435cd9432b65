"""One damaged position: its points are marked and say why, the rest stands as if nothing were."""

import json
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from analysis_requests import point_request
from spur_gears import PAIR

import fe_contact.analysis.pairs.pair_contact as room
import fe_contact.analysis.pairs.solved_contact as kept
from fe_contact import SteDatabase, analyze, flank_results
from fe_contact.contact import ContactProblem, ContactSolution, Start, solve_contact
from fe_contact.contact.sweep import solve_sets
from fe_contact.errors import SolveError
from fe_contact.types import FloatArray, Status

TORQUES = [10.0, 50.0, 100.0]
DAMAGED = 0.25


def spoiled(problem: ContactProblem) -> ContactProblem:
    """Return a problem with a compliance that is no longer definite at one position."""
    compliance = problem.compliance.copy()
    compliance[np.flatnonzero(problem.candidates.position == DAMAGED)] *= -1.0
    return replace(problem, compliance=compliance)


def damaging(problem: ContactProblem, load: FloatArray, start: Start | None = None) -> ContactSolution:
    return solve_contact(spoiled(problem), load, start)


def damaging_sets(problem: ContactProblem, sets: Sequence[FloatArray]) -> list[ContactSolution]:
    return solve_sets(spoiled(problem), sets)


def table(**how: object) -> SteDatabase:
    return analyze(PAIR, torques=TORQUES, model="plane_strain", level="draft", **how)


@pytest.fixture(scope="module", params=[{"positions": 32}, {"positions": 32, "receipt": "minimal"}, {}])
def both(request):
    """The table as it should be, and the damaged one."""
    sound = table(**request.param)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(kept, "solve_sets", damaging_sets)
        return sound, table(**request.param)


def test_the_failed_points_are_marked_and_the_rest_is_as_it_would_be(both):
    _, damaged = both
    at = damaged.position == DAMAGED
    assert at.sum() == 1
    assert np.all(damaged.status[at] == Status.SINGULAR)
    assert np.all(damaged.status[~at] == Status.CONVERGED)
    for name in ("static_transmission_error", "tangent_compliance", "max_pressure"):
        assert np.all(np.isnan(getattr(damaged, name)[at])), name
        assert np.all(np.isfinite(getattr(damaged, name)[~at])), name
    sound, damaged = both
    common = np.intersect1d(sound.position, damaged.position[damaged.position != DAMAGED])
    assert common.size >= 31
    for name in ("static_transmission_error", "load_share", "no_load_transmission_error", "residuals"):
        these, those = (getattr(t, name)[np.isin(t.position, common)] for t in (sound, damaged))
        np.testing.assert_array_equal(these, those, err_msg=name)
    assert sound.support_force.size > 0
    assert sound.metadata.receipt["support_loads_left_out"] == []
    assert damaged.support_force.size == 0
    assert len(damaged.metadata.receipt["support_loads_left_out"]) == sound.support_force.size


def test_the_table_says_which_failed_and_answers_only_if_asked(both, tmp_path):
    sound, damaged = both
    assert "3 of" in damaged.summary() and "position 0.25" in damaged.summary()
    assert "SINGULAR" in damaged.summary()
    assert damaged.metadata.receipt["failed_points"] == {"SINGULAR": len(TORQUES)}
    assessed = "error estimate" in damaged.metadata.receipt["stages"]
    assert (damaged.metadata.receipt["condition_number_max"] is not None) == assessed
    assert sound.metadata.receipt["failed_points"] == {}
    json.dumps(damaged.metadata.receipt, allow_nan=False)
    with pytest.raises(SolveError, match="SINGULAR"):
        damaged.curve(torque=100.0)
    curve = damaged.curve(torque=100.0, allow_failed=True)
    assert curve.mean.value == pytest.approx(sound.mean(torque=100.0).value, rel=0.01)
    damaged.to_netcdf(tmp_path / "ste.nc")
    assert SteDatabase.from_netcdf(tmp_path / "ste.nc").identical(damaged)


def test_flank_results_say_which_position_failed_and_why():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(room, "solve_contact", damaging)
        said = r"1 of 64 positions have no solution \(position 0.25: SINGULAR\)"
        with pytest.raises(SolveError, match=said) as error:
            flank_results(PAIR, *point_request(torque=100.0, model="plane_strain", level="draft"))
    assert isinstance(error.value.partial, ContactSolution)
