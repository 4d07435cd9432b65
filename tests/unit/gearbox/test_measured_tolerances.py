"""Tolerance studies of measured gears: a population equal to a class gives the pairs of that class."""

import json

import numpy as np
import pytest
from command_line import loa, printed
from spur_case import spur_case

from fe_contact.errors import InputError
from fe_contact.microgeometry.measured_tolerances import MeasuredTolerances, measured_tolerances
from fe_contact.microgeometry.tolerances import Tolerances

CLASS = Tolerances(
    4e-6, {"pinion.profile_slope": 9e-6, "wheel.helix_slope": 6e-6, "wheel.profile_slope": 3e-6}
)


def measured(correlation: float = 0.0) -> MeasuredTolerances:
    mean = {"wheel.profile_slope": 5e-6, "wheel.helix_slope": -2e-6}
    deviation = {"wheel.profile_slope": 2e-6, "wheel.helix_slope": 1e-6}
    return measured_tolerances(
        CLASS, mean, deviation, {("wheel.helix_slope", "wheel.profile_slope"): correlation}
    )


def test_measured_figures_have_their_mean_spread_and_correlation():
    names, sample = list(measured().widths), measured(0.8).sample(4096, 1)
    one, other = (sample[:, names.index(name)] for name in ("wheel.profile_slope", "wheel.helix_slope"))
    assert (one.mean(), other.mean()) == pytest.approx((5e-6, -2e-6), abs=0.02e-6)
    # a normal distribution truncated at three standard deviations has 0.987 of its spread
    assert (one.std(), other.std()) == pytest.approx((0.987 * 2e-6, 0.987e-6), rel=0.01)
    assert np.corrcoef(one, other)[0, 1] == pytest.approx(0.8, abs=0.01)
    alone = names.index("pinion.profile_slope")
    np.testing.assert_array_equal(sample[:, alone], CLASS.sample(4096, 1)[:, alone])
    center = {name: of.mean() for name, of in zip(names, measured().distributions, strict=True)}
    assert center["wheel.profile_slope"] == pytest.approx(5e-6)
    assert center["pinion.profile_slope"] == pytest.approx(0.0, abs=1e-12)


def test_correlations_that_no_gears_have_are_refused():
    mean = dict.fromkeys(("a", "b", "c"), 0.0)
    names = dict(zip(mean, ("pinion.profile_slope", "wheel.profile_slope", "wheel.helix_slope"), strict=True))
    pairs = {(names["a"], names["b"]): 0.9, (names["b"], names["c"]): 0.9, (names["a"], names["c"]): -0.9}
    zero, spread = dict.fromkeys(names.values(), 0.0), dict.fromkeys(names.values(), 1e-6)
    with pytest.raises(InputError, match="gears that can exist"):
        measured_tolerances(CLASS, zero, spread, pairs)
    with pytest.raises(InputError, match="two figures with a mean"):
        measured_tolerances(CLASS, zero, spread, {(names["a"], "wheel.profile_form"): 0.5})
    with pytest.raises(InputError, match="correlation"):
        measured_tolerances(CLASS, zero, spread, {(names["a"], names["b"]): 1.5})


SAMPLE = ("--class", "6", "--samples", "16", "--exact", "8")
OF = (*SAMPLE, "--limit", "1=0.5um")


@pytest.fixture(scope="module")
def case(tmp_path_factory):
    file = tmp_path_factory.mktemp("measured") / "case.toml"
    file.write_text(spur_case(torques=[100.0], model="plane_strain"), encoding="utf-8")
    return file


@pytest.mark.law
def test_a_population_equal_to_its_class_has_the_same_pairs(case):
    done = printed("scatter", case, *OF)
    widths = done["asked"]["tolerances"]
    rows = [f"{name}={0.0}/{width / 3.0!r}" for name, width in widths.items() if name.startswith("wheel.")]
    assert len(rows) == 2
    same = printed("scatter", case, *OF, "--population", ",".join(rows))
    assert same["peak_to_peak_um"] == [pytest.approx(row, rel=1e-9) for row in done["peak_to_peak_um"]]
    assert same["above"]["share"] == done["above"]["share"]
    assert done["within_class"] is None
    assert same["within_class"] == {
        "mean_um": pytest.approx(done["mean_um"], rel=1e-12),
        "share": done["above"]["share"],
        "decides": pytest.approx(done["above"]["names"][int(np.argmax(done["above"]["total"]))]),
    }


def test_a_study_of_measured_gears_says_how_the_class_errs(case):
    row = (
        "--limit",
        "1=2um",
        "--population",
        "wheel.profile_slope_um=25/1,wheel.helix_slope_um=3/1",
    )
    done = loa("scatter", case, *SAMPLE, *row)
    assert done.exit_code == 0, done.output
    assert "Within the class in place of the measured gears the mean is" in done.stdout
    shares = printed("scatter", case, *SAMPLE, *row)
    assert shares["above"]["share"][0] == 1.0
    assert shares["within_class"]["share"][0] < 0.6
    assert "wheel.helix_slope_um" not in shares["names"]  # in the plane


@pytest.mark.parametrize(
    ("row", "said"),
    [
        ("wheel.profile_slop_um=1/2", "Did you mean wheel.profile_slope_um"),
        ("wheel.profile_slope_um=1", "GEAR.FIGURE=MEAN/DEVIATION"),
        ("wheel.profile_slope_um=1/-2", "a deviation of 0 or above"),
        ("wheel.profile_slope_um=nan/2", "GEAR.FIGURE=MEAN/DEVIATION"),
        ("wheel.profile_slope_um*pinion.profile_slope_um=1/2", "GEAR.FIGURE*GEAR.FIGURE=CORRELATION"),
        ("wheel.profile_slope_um*pinion.profile_slope_um=0.5", "two figures with a mean"),
        ("=", "pinion or wheel, a dot"),
    ],
)
def test_a_row_is_refused_by_what_is_wrong(case, row, said):
    done = loa("scatter", case, *OF, "--population", row, "--json")
    assert done.exit_code == 2
    assert said in json.dumps(done.output) or said in done.stderr
