"""What a curve says stands in one look: figures with errors, harmonics in decibels, load sharing."""

import math
import re
from typing import Any

import numpy as np
import pytest
from command_line import loa
from small_table import small_table

from fe_contact.ste import SteDatabase
from lineofaction.cli.ste import _answer
from lineofaction.gearbox.convert.answers import curve_json

Json = dict[str, Any]
TORQUE = 1.0


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    file = tmp_path_factory.mktemp("table") / "ste.nc"
    small_table().to_netcdf(file)
    return file


@pytest.fixture(scope="module")
def curve(file):
    """A curve whose errors are small enough for some of its harmonics to be above them."""
    found = curve_json(SteDatabase.from_netcdf(file), torque_n_m=TORQUE)
    smaller = {name: 1e-3 * np.array(value) for name, value in found.items() if "error" in name}
    return found | {name: value.tolist() for name, value in smaller.items()}


@pytest.fixture(scope="module")
def answer(file, curve):
    return list(_answer(SteDatabase.from_netcdf(file), f"report {file}", curve))


def test_the_answer_is_one_look(file, answer):
    done = loa("ste", file, "--torque", TORQUE)
    assert done.exit_code == 0, done.output
    for lines in (answer, done.stdout.splitlines()):
        assert len(lines) <= 14
        assert all(len(line) <= 80 for line in lines if str(file) not in line)
        assert lines[0].startswith("gear pair 20/20 at 1 N m (")
        assert lines[-1].startswith(f"next: loa report {file}")


def test_figures_are_those_of_the_curve_with_two_digits_of_the_error(answer, curve):
    for name, key in (("mean", "mean_um"), ("peak to peak", "peak_to_peak_um")):
        (line,) = (line for line in answer if line.startswith(f"  {name} "))
        found = re.match(rf"  {name} +([\d.]+) +± ([\d.]+) µm", line)
        places = len(found[2].partition(".")[2])
        assert places == len(found[1].partition(".")[2]) and 9.5 < float(found[2]) * 10.0**places < 100.0
        last = 0.51 * 10.0**-places
        assert float(found[1]) == pytest.approx(curve[key], abs=last)
        assert float(found[2]) == pytest.approx(curve[key.replace("_um", "_error_um")], abs=last)


def test_harmonics_above_their_errors_are_in_decibels_and_the_others_are_named(answer, curve):
    sizes, errors = (dict(enumerate(curve[name][:8], 1)) for name in ("harmonics_um", "harmonics_error_um"))
    sure = {order for order, size in sizes.items() if size > errors[order]}
    assert 1 < len(sure) < 8
    pattern = r"  harmonic (\d) +([\d.]+) +± [\d.]+ µm +(-?[\d.]+) dB re 1 µm  ?(█*)"
    found = {int(line[1]): line for line in (re.match(pattern, line) for line in answer) if line}
    assert set(found) == sure
    for order, line in found.items():
        assert float(line[3]) == pytest.approx(20.0 * math.log10(sizes[order]), abs=0.051)
        assert len(line[4]) == round(16 * sizes[order] / max(sizes[k] for k in sure))
    (rest,) = (line for line in answer if "their error" in line)
    assert {int(order) for order in re.findall(r"\d+", rest.partition(":")[0])} == set(sizes) - sure


def test_the_ripple_is_drawn_over_two_periods(answer, curve):
    (line,) = (line for line in answer if line.endswith("two periods"))
    drawn = line.removesuffix("two periods").split()[-1]
    half, ste = len(drawn) // 2, np.array(curve["ste_um"])
    assert drawn[:half] == drawn[half:]
    assert {drawn[0], drawn[ste.argmax() * half // ste.size]} == {"█"} == {max(drawn)}
    assert drawn[round(ste.argmin() * half / ste.size)] == min(drawn) == "▁"


def test_positions_are_printed_where_they_are_requested(file):
    whole = loa("ste", file, "--torque", TORQUE, "--table").stdout.splitlines()
    some = loa("ste", file, "--torque", TORQUE, "--at", "0,0.25").stdout.splitlines()
    assert whole[0].split()[:2] == some[0].split()[:2] == ["position", "ste_um"]
    assert len(some) == 3
    assert len(whole) == 1 + len(SteDatabase.from_netcdf(file).position)


def test_the_error_of_a_point_names_the_part_of_interpolation(file, curve):
    def said(**bands):
        lines = _answer(SteDatabase.from_netcdf(file), "report", curve | bands)
        return next(line.strip() for line in lines if "error of a point" in line)

    bands = {"error_um": [0.05, 0.2], "interval_error_um": 0.12}
    assert said(**bands) == "error of a point: up to 0.2 µm, 0.12 µm of it by interpolation between the nodes"
    assert said(**bands | {"interval_error_um": 0.0}) == "error of a point: up to 0.2 µm"


def test_every_row_of_a_list_has_the_error_of_its_point(file):
    table = SteDatabase.from_netcdf(file)
    header, *rows = loa("ste", file, "--torque", "30", "--at", "0,0.25,0.6", "--csv").stdout.splitlines()
    assert header.split(",")[-1] == "ste_error_um"
    errors = [float(row.split(",")[-1]) for row in rows]
    curve = table.curve(torque=30.0, at=[0.0, 0.25, 0.6])
    assert errors == pytest.approx((1e6 * curve.error).tolist(), rel=1e-2)
    told = curve_json(table, torque_n_m=30.0)
    assert told["interval_error_um"] == 1e6 * curve.interval_error
    assert "inserted" not in told
