"""Reduced housings on disk, in matrices of other programs, and what they cost."""

import math
import time
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from lattice_meshes import tube
from scipy.io import mmwrite
from varied_housing import meshed

from dynamics.errors import InputError, ResultError
from dynamics.housings import (
    Bore,
    CostLimit,
    Foot,
    Material,
    MaterialDamping,
    MeshedHousing,
    Plane,
    ReducedHousing,
    ReducedMatrices,
    SeatBore,
    housing_of_matrices,
    read_matrix_market,
    read_reduced_matrices,
    receptance,
    reduced_housing,
    reduction_cost,
)
from dynamics.housings import reduction as kept_module
from dynamics.housings.cached_reduction import content_key
from dynamics.housings.reduction import reduce_housing

WITHIN = 1.3
"""Factor within which a cost is predicted."""

SEAT = SeatBore("upper", Bore((0.0, 0.0, 0.075), (0.0, 0.0, 1.0), 0.08, 0.05))
HOUSING = MeshedHousing(
    tube(0.12, 0.08, 0.1, (8, 1, 2)),
    Material(210e9, 0.3, 7850.0),
    (SEAT,),
    (Foot("base", Plane((0.0, 0.0, 0.0), (0.0, 0.0, -1.0))),),
    {"top": (0.06, 0.0, 0.1)},
    modes=6,
)


def test_the_second_time_comes_from_the_cache_to_the_last_bit(tmp_path, monkeypatch):
    first = reduced_housing(HOUSING, tmp_path)
    monkeypatch.setattr(kept_module, "reduce_housing", lambda _: pytest.fail("computed again"))
    again = reduced_housing(HOUSING, tmp_path, CostLimit(0.0, 0.0))
    for name in ("mass", "stiffness", "damping", "frequency", "damping_ratio"):
        assert np.array_equal(getattr(first, name), getattr(again, name))
    assert np.array_equal(first.surface.motion, again.surface.motion)
    assert again.seats[0].motions == first.seats[0].motions
    assert (again.seats[0].ring, again.checks) == (first.seats[0].ring, first.checks)
    assert np.array_equal(again.points[0].motion, first.points[0].motion)


def test_a_damaged_file_is_computed_again(tmp_path):
    first = reduced_housing(HOUSING, tmp_path)
    (file,) = tmp_path.glob("housing-*.nc")
    file.write_bytes(file.read_bytes()[:-400])
    assert np.array_equal(reduced_housing(HOUSING, tmp_path).mass, first.mass)
    with pytest.raises(ResultError):
        ReducedHousing.from_netcdf(tmp_path / "absent.nc")


def test_everything_that_decides_the_result_is_in_the_key():
    moved = replace(HOUSING.mesh, points=HOUSING.mesh.points * (1.0 + 1e-15))
    changes = [
        {"mesh": moved},
        {"mesh": replace(HOUSING.mesh, groups={"a": np.array([1])})},
        {"material": Material(210e9, 0.3, 7851.0)},
        {"seats": (replace(SEAT, motions=6),)},
        {"feet": ()},
        {"points": {}},
        {"modes": 7},
        {"damping": MaterialDamping(0.02)},
    ]
    keys = {content_key(HOUSING), *(content_key(replace(HOUSING, **change)) for change in changes)}
    assert len(keys) == len(changes) + 1


@pytest.mark.parametrize(("limit", "field"), [((1e-6, 1e12), "seconds"), ((1e6, 1.0), "bytes")])
def test_what_would_cost_too_much_is_refused_before_it_runs(limit, field, monkeypatch):
    monkeypatch.setattr(kept_module, "reduce_housing", lambda _: pytest.fail("computed"))
    with pytest.raises(InputError, match=f"{HOUSING.mesh.freedoms} freedoms, 6 modes") as caught:
        reduced_housing(HOUSING, None, CostLimit(*limit))
    assert caught.value.field == f"predicted_{field}"


def test_cost_grows_with_freedoms_modes_and_seats():
    sizes = ((50_000, 40, 20), (100_000, 40, 20), (100_000, 80, 20), (100_000, 80, 40))
    costs = [reduction_cost(*size) for size in sizes]
    for less, more in pairwise(costs):
        assert less.seconds < more.seconds and less.bytes < more.bytes
    assert costs[1].seconds > 2.0 * costs[0].seconds


def test_the_predicted_cost_of_two_sizes_is_in_the_ratio_of_the_measured():
    """Each is within 1.3 of what it takes, their ratio within the square; the lesser of two counts."""
    sizes = [meshed(), meshed((24, 1, 10))]
    minimum = [math.inf, math.inf]
    for _ in range(2):
        for index, housing in enumerate(sizes):
            began = time.process_time()
            reduce_housing(housing)
            minimum[index] = min(minimum[index], time.process_time() - began)
    motions = [sum(seat.motions for seat in housing.seats) for housing in sizes]
    facts = zip(sizes, motions, strict=True)
    small, large = (reduction_cost(own.mesh.freedoms, own.modes, seated).seconds for own, seated in facts)
    assert large / small > 2.0
    assert 1.0 / WITHIN**2 < (large / small) / (minimum[1] / minimum[0]) < WITHIN**2


def test_the_cost_is_kept_with_the_housing_and_told_before(tmp_path):
    told = []
    first = reduced_housing(HOUSING, tmp_path, expected=told.append)
    assert first.cost.seconds > 0.0
    assert [tuple(cost) for cost in told] == [(first.cost.predicted_seconds, first.cost.predicted_bytes)]
    again = reduced_housing(HOUSING, tmp_path, expected=lambda _: pytest.fail("told of what is kept"))
    assert again.cost == first.cost
    assert reduce_housing(HOUSING).cost is None


def saved(path: Path, reduced: ReducedHousing):
    matrices = {"stiffness": reduced.stiffness, "mass": reduced.mass, "damping": reduced.damping}
    if path.suffix == ".npz":
        np.savez(path, **matrices)
    elif path.suffix == ".mtx":
        for name, matrix in matrices.items():
            mmwrite(path.with_name(f"{name}.mtx"), matrix, precision=17)
        return read_matrix_market(*(path.with_name(f"{name}.mtx") for name in matrices))
    elif path.suffix == ".op4":
        op4 = pytest.importorskip("pyyeti.nastran.op4", reason="the extra nastran")
        op4.write(str(path), {"kaa": reduced.stiffness, "maa": reduced.mass, "baa": reduced.damping})
    else:
        bulk = pytest.importorskip("pyyeti.nastran.bulk", reason="the extra nastran")
        pandas = pytest.importorskip("pandas")
        index = pandas.MultiIndex.from_tuples(
            [(1 + row // 6, 1 + row % 6) for row in range(len(reduced.mass))]
        )
        names = {"KAAX": reduced.stiffness, "MAAX": reduced.mass, "BAAX": reduced.damping}
        bulk.wtdmig(str(path), {k: pandas.DataFrame(m, index, index) for k, m in names.items()})
    return read_reduced_matrices(path)


@pytest.mark.parametrize("suffix", [".npz", ".mtx", ".op4", ".pch"])
def test_matrices_of_another_program_give_the_same_housing(tmp_path, suffix):
    reduced = reduced_housing(HOUSING)
    back = housing_of_matrices(saved(tmp_path / f"housing{suffix}", reduced), reduced.seats)
    frequencies = np.array([0.0, 0.5]) * reduced.frequency[-1]
    assert back.frequency[:6] == pytest.approx(reduced.frequency, rel=1e-6)
    assert back.damping_ratio[:6] == pytest.approx(reduced.damping_ratio, rel=1e-5)
    expected = receptance(reduced, frequencies)[:, :5]
    assert np.abs(receptance(back, frequencies)[:, :5] - expected).max() < 1e-5 * np.abs(expected).max()


def test_stiffness_alone_is_a_housing_without_mass():
    seats = reduced_housing(HOUSING).seats
    stiffness = np.diag([1e8, 1e8, 1e8, 1e5, 1e5])
    static = housing_of_matrices(ReducedMatrices(stiffness), seats)
    assert static.frequency.size == 0
    found = receptance(static, np.array([0.0, 1000.0]))
    assert found == pytest.approx(np.broadcast_to(np.linalg.inv(stiffness), (2, 5, 5)))


def test_matrices_without_damping_get_that_of_the_material():
    reduced = reduced_housing(HOUSING)
    found = housing_of_matrices(ReducedMatrices(reduced.stiffness, reduced.mass), reduced.seats)
    assert np.abs(found.damping - reduced.damping).max() < 1e-9 * np.abs(reduced.damping).max()


@pytest.mark.parametrize(
    ("arrays", "field"),
    [
        ({"mass": np.eye(5)}, "matrix_file"),
        ({"stiffness": -np.eye(5)}, "stiffness"),
        ({"stiffness": np.eye(5), "mass": np.eye(4)}, "mass"),
        ({"stiffness": np.triu(np.ones((5, 5)))}, "stiffness"),
        ({"stiffness": np.eye(4)}, "seats"),
    ],
)
def test_matrices_that_are_no_housing_are_refused_by_name(tmp_path, arrays, field):
    np.savez(tmp_path / "bad.npz", **arrays)
    seats = reduced_housing(HOUSING).seats
    with pytest.raises(InputError) as caught:
        housing_of_matrices(read_reduced_matrices(tmp_path / "bad.npz"), seats)
    assert caught.value.field == field


def test_a_file_without_matrices_is_one_clear_error(tmp_path):
    (tmp_path / "text.npz").write_text("no archive")
    for name in ("text.npz", "absent.npz"):
        with pytest.raises(InputError, match="matrix_file"):
            read_reduced_matrices(tmp_path / name)
    with pytest.raises(InputError, match="suffix"):
        read_reduced_matrices(tmp_path / "matrices.txt")
