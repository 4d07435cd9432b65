"""Frequency responses of a universal file: the modal answer back, senses and units by hand, attacks."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from measured_housings import UNITS, function, universal_file
from reduced_housings import PAIR, random_housing

from dynamics.vibration import (
    Direction,
    MotionQuantity,
    housing_vibration,
    measured_vibration,
    transfer_functions,
)
from lineofaction.gearbox.convert.measured_housings import measured_mobility
from lineofaction.gearbox.problems import BadInput

LINES = np.arange(50.0, 1501.0, 2.5)
SEATS, POINTS = {1: "left"}, {11: "lid"}


def read(file: Path, seats=SEATS, points=POINTS, axes=None):
    return measured_mobility(file, seats, points, axes)


def exported(folder: Path, kind: str, **changed: Any) -> Path:
    """Write what a measurement of the modal housing gives: forces along the scene's axes, no moments."""
    housing = random_housing()
    rows = np.concatenate([point.motion for point in housing.points])
    response = transfer_functions(housing, LINES, rows, None, MotionQuantity(kind))
    turned = np.zeros((LINES.size, 6, 3 * len(PAIR)), dtype=complex)
    for seat, frame in enumerate(housing.seats):  # columns of a seat's own axes: forces are the first three
        turned[..., 3 * seat : 3 * seat + 3] = response[..., 5 * seat : 5 * seat + 3] @ frame.axes.T
    sets = [
        function(LINES, turned[:, q, e], (11 + q // 3, q % 3 + 1, 1 + e // 3, e % 3 + 1), kind, **changed)
        for q in range(6)
        for e in range(12)
    ]
    return universal_file(folder / f"{kind}.uff", sets)


@pytest.mark.parametrize(("kind", "binary"), [("displacement", 0), ("velocity", 1), ("acceleration", 0)])
def test_an_export_of_a_modal_housing_gives_its_vibration_back(kind, binary, tmp_path):
    """Within 0.1 dB at the lines; not within 0.1 dB of its mirror image, so that it is no accident."""
    draw = np.random.default_rng(5)
    force = draw.normal(size=(4, 3, 5, 6)) + 1j * draw.normal(size=(4, 3, 5, 6))
    response = SimpleNamespace(
        bearing=PAIR,
        bearing_force=force,
        speed=np.arange(1.0, 6.0),
        order=np.arange(1.0, 7.0),
        frequency=draw.choice(LINES, size=(5, 6)),
        in_contact=np.ones(5, dtype=bool),
        floor=None,
    )
    modal = housing_vibration(response, random_housing())
    mobility = read(
        exported(tmp_path, kind, binary=binary),
        dict(zip(range(1, 5), PAIR, strict=True)),
        {11: "a", 12: "b"},
    )
    found = measured_vibration(response, mobility)
    assert found.point == ("a", "b")
    assert not found.omitted
    np.testing.assert_allclose(found.velocity, modal.velocity, rtol=1e-4)
    assert np.abs(20.0 * np.log10(found.rms / modal.rms)).max() < 0.1


@pytest.mark.parametrize("towards", [1, -2, 3])
@pytest.mark.parametrize("pushed", [-1, 2, -3])
def test_a_direction_below_zero_is_against_its_axis(towards, pushed, tmp_path):
    """2 m/s^2 per N towards -y and a push along y: -2 along y, a mobility of -2 / (2 pi i f)."""
    file = universal_file(tmp_path / "a.uff", [function(LINES, 2.0 + 0.0 * LINES, (11, towards, 1, pushed))])
    found = read(file)
    assert found.response == (Direction("lid", abs(towards) - 1),)
    assert found.excitation == (Direction("left", abs(pushed) - 1),)
    sense = (1 if towards > 0 else -1) * (1 if pushed > 0 else -1)
    np.testing.assert_allclose(found.mobility[:, 0, 0], sense * 2.0 / (2j * np.pi * LINES), rtol=1e-5)


def test_reciprocity_is_not_assumed(tmp_path):
    """Both nodes are seat and point, their two functions differ: each stays where it was measured."""
    sets = [
        function(LINES, size + 0.0 * LINES, ends, "velocity")
        for size, ends in ((2.0, (1, 1, 2, 1)), (5.0, (2, 1, 1, 1)), (3.0, (1, 1, 1, 1)), (4.0, (2, 1, 2, 1)))
    ]
    found = read(universal_file(tmp_path / "a.uff", sets), {1: "left", 2: "right"}, {1: "p", 2: "q"})
    value = {
        (point.name, seat.name): found.mobility[9, q, e].real
        for q, point in enumerate(found.response)
        for e, seat in enumerate(found.excitation)
    }
    assert value["p", "right"] == pytest.approx(2.0)
    assert value["q", "left"] == pytest.approx(5.0)


@pytest.mark.parametrize(
    ("labels", "units", "factor"),
    [
        (("m/s^2", "N"), None, 1.0),
        (("g", "N"), None, 9.80665),
        (("mm/s^2", "kN"), None, 1e-6),
        (("(m/s^2)/N", "NONE"), None, 1.0),
        (("g/kN", "NONE"), None, 9.80665e-3),
        (("NONE", "NONE"), (1e3, 1.0), 1e-3),
        (("m/s^2", "N"), (1.0, 1.0), 1.0),
    ],
)
def test_units_are_those_of_labels_or_of_the_file(labels, units, factor, tmp_path):
    names = dict(zip(("ordinate_axis_units_lab", "orddenom_axis_units_lab"), labels, strict=True))
    sets = [function(LINES, 1.0 + 0.0 * LINES, **names)]
    if units is not None:
        sets = [UNITS | {"length": units[0], "force": units[1]}, *sets]
    found = read(universal_file(tmp_path / "a.uff", sets))
    np.testing.assert_allclose(found.mobility[:, 0, 0] * 2j * np.pi * LINES, factor, rtol=1e-5)


def test_other_functions_and_a_line_at_rest_are_passed_over(tmp_path):
    lines = np.arange(0.0, 101.0)
    sets = [
        function(lines, 1.0 + 0.0 * lines),
        function(lines, 1.0 + 0.0 * lines, func_type=6),  # coherence of the same pair
        function(LINES, 1.0 + 0.0 * LINES, (99, 1, 1, 1)),  # another point, other lines
    ]
    found = read(universal_file(tmp_path / "a.uff", sets))
    assert found.frequency[0] == 1.0
    assert found.mobility.shape == (100, 1, 1)


def attack(*, ends=(11, 1, 1, 1), lines=LINES, values=None, **changed: Any) -> list[dict[str, Any]]:
    return [function(lines, np.ones(len(lines)) if values is None else values, ends, **changed)]


NO_LABELS = {"ordinate_axis_units_lab": "NONE", "orddenom_axis_units_lab": "NONE"}
ATTACKS = {
    "no functions": (attack(func_type=6), "a file with frequency responses; it has none"),
    "unit of neither": (attack(**NO_LABELS), "11:.1 per 1:.1.*states its unit of acceleration"),
    "unit of motion": (attack(ordinate_axis_units_lab="NONE"), "states its unit of acceleration"),
    "unit of force": (attack(orddenom_axis_units_lab="NONE"), "states its unit of force"),
    "unit of another kind": (attack(ordinate_axis_units_lab="mm"), "unit of acceleration; its label says mm"),
    "units twice": ([UNITS | {"length": 1e3}, *attack()], "its label says m/s.2, dataset 164 another"),
    "units of nothing": ([UNITS | {"length": 0.0}, *attack(**NO_LABELS)], "dataset 164. are above 0"),
    "no response type": (attack(ordinate_spec_data_type=9), "numerator of type 8, 11 or 12"),
    "per motion": (attack(orddenom_spec_data_type=12), "a response per force"),
    "over time": (attack(abscissa_spec_data_type=17), "over frequency .abscissa of type 18"),
    "no such seat": (attack(ends=(11, 1, 5, 1)), "a reference node of a.uff: 5"),
    "no such point": (attack(ends=(12, 1, 1, 1)), "a response node of a.uff: 12"),
    "rotation": (attack(ends=(11, 1, 1, 4)), "11:.1 per 1:.4.*along x, y or z"),
    "scalar": (attack(ends=(11, 0, 1, 1)), "along x, y or z"),
    "twice": ([*attack(), *attack(ends=(11, -1, 1, 1))], "one function of lid x per left x"),
    "a hole": ([*attack(), *attack(ends=(11, 2, 1, 2))], "a function of lid x per left y"),
    "other lines": (
        [*attack(), *attack(ends=(11, 2, 1, 1), lines=LINES + 1.0)],
        "11:.2 per 1:.1.*same 581 lines",
    ),
    "fewer lines": ([*attack(), *attack(ends=(11, 2, 1, 1), lines=LINES[:-3])], "same 581 lines"),
    "backward": (attack(lines=LINES[::-1]), "frequency rises"),
    "at rest alone": (attack(lines=np.array([0.0, 5.0])), "at least two lines"),
}


@pytest.mark.parametrize("name", ATTACKS)
def test_a_file_that_cannot_be_used_is_refused_by_name(name, tmp_path):
    sets, message = ATTACKS[name]
    with pytest.raises(BadInput, match=message) as refused:
        read(universal_file(tmp_path / "a.uff", sets))
    assert str(refused.value).startswith("file = ")


def test_a_function_that_is_cut_off_and_a_foreign_file_are_refused(tmp_path):
    file = universal_file(tmp_path / "a.uff", attack())
    text = file.read_text().splitlines(keepends=True)
    file.write_text("".join(text[:40] + text[-1:]))
    with pytest.raises(BadInput, match=r"as many values as they say|can be read"):
        read(file)
    file.write_bytes(b"\x89HDF\r\n\x1a\n" * 40)
    with pytest.raises(BadInput, match=r"^file = "):
        read(file)
    with pytest.raises(BadInput, match=r"ends in \.unv, \.uff, \.uf"):
        read(tmp_path / "a.mat")
    with pytest.raises(BadInput, match="Check the path"):
        read(tmp_path / "gone.uff")


@pytest.mark.parametrize("value", ["nan", "inf"])
def test_a_value_that_is_no_number_is_refused_with_its_line(value, tmp_path):
    file = universal_file(tmp_path / "a.uff", attack())
    text = file.read_text()
    line = "  6.75000e+01   1.00000000000e+00"
    assert text.count(line) == 1
    file.write_text(text.replace(line, f"  6.75000e+01{value:>20}"))
    with pytest.raises(BadInput, match=r"lid x per left x.*finite at every line; it is not at 67\.5 Hz"):
        read(file)


def test_real_values_are_no_frequency_response(tmp_path):
    part = attack()[0] | {"data": np.ones(LINES.size)}
    with pytest.raises(BadInput, match="complex values"):
        read(universal_file(tmp_path / "a.uff", [part]))
