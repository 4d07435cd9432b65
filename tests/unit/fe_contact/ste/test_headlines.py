"""What a Python prompt shows of a database and of a number with its error."""

import copy
import math
import pickle
import sys
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from bounds.brief import MAX_LINES, WIDTH
from fe_contact.types import Estimate
from host.extras import MissingExtra


@pytest.mark.parametrize(
    ("estimate", "unit", "text"),
    [
        (Estimate(2.44e-7, 1.0e-8, "m"), "um", "0.244 ± 0.010 µm"),
        (Estimate(2.44e-7, 1.0e-8, "m"), "nm", "244 ± 10 nm"),
        (Estimate(9.7861e-6, 3.47e-8, "m"), "um", "9.786 ± 0.035 µm"),
        (Estimate(9.7861e-6, 9.96e-8, "m"), "um", "9.79 ± 0.10 µm"),
        (Estimate(1.2389e9, 1.8e7, "Pa"), "MPa", "1239 ± 18 MPa"),
        (Estimate(1.31, 0.0125, ""), "", "1.310 ± 0.013"),
        (Estimate(1.0e-6, math.nan, "m"), "um", "1 µm, no error stated"),
        (Estimate(-3.0e-6, 2.0e-6, "m"), "um", "-3.0 ± 2.0 µm"),
    ],
)
def test_a_number_has_the_digits_that_its_error_leaves(estimate, unit, text):
    assert format(estimate, unit) == text


def test_a_unit_of_another_quantity_is_refused():
    with pytest.raises(ValueError, match="a number in m is not written in MPa; units: m, mm"):
        format(Estimate(1.0, 0.1, "m"), "MPa")


def test_half_a_band_is_the_standard_deviation_of_uncertainties(monkeypatch):
    package = SimpleNamespace(ufloat=lambda value, deviation: (value, deviation))  # an extra that CI lacks
    monkeypatch.setitem(sys.modules, "uncertainties", package)
    assert Estimate(2.0e-7, 1.0e-8, "m").ufloat() == (2.0e-7, 5.0e-9)


def test_without_the_extra_its_name_is_said(monkeypatch):
    monkeypatch.setitem(sys.modules, "uncertainties", None)
    with pytest.raises(MissingExtra, match=r"pip install 'lineofaction\[uncertainties\]'"):
        Estimate(1.0, 0.1, "m").ufloat()


def test_a_database_equals_its_copies_which_stay_read_only(spur):
    for other in (pickle.loads(pickle.dumps(spur)), copy.copy(spur), copy.deepcopy(spur)):
        assert other is not spur and other == spur and hash(other) == hash(spur)
        assert not other.static_transmission_error.flags.writeable
    assert spur != replace(spur, error_estimate=2.0 * spur.error_estimate)
    assert spur != replace(spur, metadata=replace(spur.metadata, warnings=({"message": "no"},)))


def test_the_text_of_a_database_says_its_figures_in_a_dozen_lines(spur):
    lines = repr(spur).split("\n")
    assert lines[0] == "SteDatabase 20/20, center distance 80 mm"
    assert len(lines) <= MAX_LINES and max(map(len, lines)) <= WIDTH
    torque = float(spur.torque[-1])
    figures = next(line for line in lines if line.split()[:2] == ["at", f"{torque:.4g}"])
    curve = spur.curve(torque=torque, misalignment=0.0, center_distance_change=0.0)
    assert f"mean {curve.mean}, p-p {curve.peak_to_peak}, order 1 {curve.harmonics[0]}" in figures
    assert "<table>" in spur._repr_html_()


def test_failed_points_are_counted(spur):
    status, ste = spur.status.copy(), spur.static_transmission_error.copy()
    status[0, 0], ste[0, 0] = 2, np.nan
    failed = replace(spur, status=status, static_transmission_error=ste)
    assert f"{int(np.count_nonzero(status))} points failed" in repr(failed)
