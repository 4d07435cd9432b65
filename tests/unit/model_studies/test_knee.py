"""The front of error against time, and its knee."""

import numpy as np
import pytest

from model_studies import FidelityResult, front_of, knee_above, knee_of


def test_the_front_leaves_out_what_another_point_beats():
    points = {"a": (1.0, 1.0), "b": (2.0, 0.1), "slow": (3.0, 0.2), "c": (10.0, 0.05)}
    assert front_of(points) == ("a", "b", "c")


def test_the_knee_is_where_time_stops_buying_accuracy():
    """Times a decade apart buy two decades of error, then a tenth of one."""
    points = {"a": (1.0, 1.0), "b": (10.0, 1e-2), "c": (100.0, 8e-3), "d": (1000.0, 7e-3)}
    assert knee_of(points) == "b"
    scaled = {name: (7.0 * time, 0.3 * error) for name, (time, error) in points.items()}
    assert knee_of(scaled) == "b"
    assert knee_of({name: points[name] for name in "ab"}) is None
    straight = {"a": (1.0, 1.0), "b": (10.0, 0.1), "c": (100.0, 0.01)}
    assert knee_of(straight) is None


def test_the_front_goes_on_level_to_the_slowest_point():
    line = {str(k): (10.0**k, 10.0**-k) for k in range(4)}
    assert knee_of(line) is None
    assert knee_of(line | {"corner": (1.1, 2e-3)}) == "corner"


def test_units_and_what_others_beat_do_not_move_the_knee():
    rng, knees = np.random.default_rng(5), set()
    for _ in range(200):
        points = {str(k): (float(t), float(e)) for k, (t, e) in enumerate(10.0 ** rng.normal(size=(6, 2)))}
        knee = knee_of(points)
        assert knee_of({name: (60.0 * time, 100.0 * error) for name, (time, error) in points.items()}) == knee
        assert knee is None or knee in front_of(points)
        slowest = max(time for time, _ in points.values())
        beaten = {"beaten": (0.99 * slowest, 2.0 * max(error for _, error in points.values()))}
        assert knee_of(points | beaten) == knee
        knees.add(knee)
    assert len(knees) > 4


class Result(FidelityResult):
    @property
    def error(self) -> float:
        """In the place of its title."""
        return float(self.title)


@pytest.mark.parametrize(("shared", "knee"), [((), "c"), ((1e-2,), "b"), ((float("nan"),), "c")])
def test_differences_below_errors_that_all_share_buy_nothing(shared, knee):
    """Every result is a decade dearer; c is far better than b unless both share an error of b's size."""
    errors = {"a": 1.0, "b": 1e-2, "c": 1e-6, "d": 5e-7, "reference": 5e-7}
    results = [Result(name, str(error), 10.0**k) for k, (name, error) in enumerate(errors.items())]
    assert knee_above(results, *shared) == knee


def test_the_error_of_the_reference_counts_as_shared():
    errors = {"a": 1.0, "b": 1e-2, "c": 1e-6, "d": 5e-7, "reference": 1e-2}
    results = [Result(name, str(error), 10.0**k) for k, (name, error) in enumerate(errors.items())]
    assert knee_above(results) == "b"
    unknown = [*results[:-1], Result("reference", "nan", 1e4)]
    assert knee_above(unknown) == "c"
