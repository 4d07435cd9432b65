"""`loa validate`: cases are files, data that is missing is no agreement, a difference needs its cause."""

import json
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from random import Random
from typing import Any

import pytest
from command_line import loa

from lineofaction.gearbox.problems import EXIT_BAD_INPUT, EXIT_FAILED, BadInput
from lineofaction.validation import CASES, Comparison, markdown, read_case
from lineofaction.validation.case import REFERENCE
from lineofaction.validation.comparison import last_digit
from lineofaction.validation.run import NO_DATA, run_case

QUICK = (
    "iso_tr_6336_30",
    "rikor_forces",
    "nafems_cylinder",
    "masta_ball_bearing_axial",
    "masta_ball_bearing_radial",
    "palermo_force",
)
LISTED = ("stplus_fzg_c", "stplus_helical_25_40", "machine_wheel_97340", "machine_pinion_95911")
FILE = '''
title = "Contact ratio of a pair of my own"
source = "a book"
licence = "figures cited"
assumed = []
verb = "geometry CASE"
case = """
[pair]
normal_module_mm = 4.0
center_distance_mm = 80.0
pinion = {{ teeth = 20, face_width_mm = 25.0, bore_diameter_mm = 40.0 }}
wheel = {{ teeth = 20, face_width_mm = 25.0, bore_diameter_mm = 40.0 }}

[load]
torque_n_m = [100.0]
"""

[[compared]]
quantity = "transverse contact ratio"
value = "{value}"
key = "mesh.transverse_contact_ratio"
why = "{why}"
'''


def no_verb(_words: object) -> dict[str, Any]:
    raise AssertionError


def validated_file(folder: Path, value: str, why: str = "") -> tuple[int, dict[str, Any]]:
    """Return exit code and comparison of a file beside the cases of the program."""
    file = folder / "mine.toml"
    file.write_text(FILE.format(value=value, why=why), encoding="utf-8")
    ran = loa("validate", str(file), "--json")
    (case,) = json.loads(ran.stdout)["cases"]
    return ran.exit_code, case["comparisons"][0]


def test_at_least_a_dozen_cases_have_a_source_a_licence_and_rows_or_data():
    cases = [read_case(path) for path in CASES.values()]
    assert len(cases) >= 12
    for case in cases:
        assert case.source
        assert case.licence
        assert case.compared or case.data, case.name


@pytest.mark.parametrize("name", QUICK)
def test_published_numbers_are_met(name):
    outcome = run_case(read_case(CASES[name]), no_verb)
    assert outcome.comparisons, outcome.reason
    assert all(row.agrees for row in outcome.comparisons)


@pytest.mark.parametrize("name", LISTED)
def test_listed_and_measured_numbers_are_met_where_the_data_is(name):
    outcome = run_case(read_case(CASES[name]), no_verb)
    if outcome.reason == NO_DATA:
        pytest.skip("the data of others is not here")
    assert len(outcome.comparisons) > 20, outcome.reason
    assert outcome.unexplained == ()
    assert sum(not row.agrees for row in outcome.comparisons) <= 1


@pytest.mark.nightly
@pytest.mark.parametrize("name", sorted(set(CASES) - {*QUICK, *LISTED}))
def test_every_difference_has_its_cause(name):
    ran = loa("validate", name, "--json")
    (case,) = json.loads(ran.stdout)["cases"]
    assert ran.exit_code == 0, case
    assert case["comparisons"] or case["reason"] == NO_DATA


def test_without_its_data_a_case_is_not_run_and_agrees_with_nothing(monkeypatch, tmp_path):
    monkeypatch.setenv(REFERENCE, str(tmp_path))
    case = read_case(CASES["stplus_fzg_c"]).model_copy(update={"data": "of_nobody.csv"})
    outcome = run_case(case, no_verb)
    assert (outcome.reason, outcome.comparisons, outcome.failed) == (NO_DATA, (), False)
    assert "not run: data not found" in markdown([outcome])


def test_a_file_of_anybody_is_a_case_and_a_difference_needs_its_cause(tmp_path):
    code, row = validated_file(tmp_path, "1.5568")
    assert (code, row["verdict"]) == (0, "agrees")
    code, row = validated_file(tmp_path, "1.60")
    assert (code, row["verdict"]) == (EXIT_FAILED, "differs")
    assert row["difference"] == pytest.approx(1.55684 / 1.6 - 1.0, rel=1e-3)
    code, row = validated_file(tmp_path, "1.60", "a misprint")
    assert (code, row["verdict"], row["why"]) == (0, "differs", "a misprint")


def test_agreement_is_a_difference_within_the_sum_of_both_errors():
    row = Comparison("force", "N", 100.0, 1.0, 101.4, 0.5)
    assert row.agrees
    assert not replace(row, ours=101.6).agrees
    assert not replace(row, their_error=0.5).agrees


@pytest.mark.parametrize(("text", "error"), [("1.5568", 5e-5), ("2660", 0.5), ("1.50e3", 5.0)])
def test_a_printed_number_is_good_to_half_of_its_last_digit(text, error):
    assert last_digit(text) == pytest.approx(error, rel=1e-12)


@pytest.mark.parametrize(
    ("change", "field"),
    [
        ('function = "os:getcwd"\nverb = "geometry CASE"', "function"),
        ('verbs = "geometry CASE"', "verbs"),
        ('verb = "geometry CASE"\nmeasured = true\n[[compared]]\nquantity = "x"', "value"),
    ],
)
def test_a_file_with_a_wrong_field_is_refused_by_it(tmp_path, change, field):
    file = tmp_path / "wrong.toml"
    file.write_text(f'title = "t"\nsource = "s"\nlicence = "l"\nassumed = []\n{change}', encoding="utf-8")
    with pytest.raises(BadInput, match=field):
        read_case(file)
    assert loa("validate", str(file)).exit_code == EXIT_BAD_INPUT


@pytest.mark.parametrize(
    ("line", "field"),
    [
        ('function = "os:getcwd"', "function"),
        ('function = "lineofaction.gearbox.result_files:stamp"', "function"),
        ('function = "lineofaction.validation.computed.pairs:__import__"', "function"),
        ('function = "lineofaction.validation.computed.pairs.os:remove"', "function"),
        ('verb = "cache clear"', "verb"),
        ('verb = "geometry CASE -o owned.json"', "verb"),
        ('verb = "modes examples/../../etc/passwd.toml"', "verb"),
        ('verb = "geometry /etc/passwd"', "verb"),
        ('verb = "geometry CASE"\ndata = "../../../etc/passwd"', "data"),
        ('verb = "geometry CASE"\ndata = "/etc/passwd"', "data"),
        ('verb = "geometry CASE"\ndata = "a/../../b"', "data"),
        ('verb = "geometry CASE"\n[[compared]]\nquantity = "q"\nvalue = "1"\nkey = "x.__class__"', "key"),
        ('verb = "geometry CASE"\n[[compared]]\nquantity = "q"\nvalue = "1e999"\nkey = "x"', "value"),
        ('verb = "geometry CASE"\n[[compared]]\nquantity = "q"\nvalue = "nan"\nkey = "x"', "value"),
        ('verb = "geometry CASE"\ncompared = "x"', "compared"),
        ('verb = "geometry CASE"\narguments = 5', "arguments"),
        ('verb = "geometry CASE"\nname = "rikor_forces"', "name"),
    ],
)
def test_a_file_of_a_stranger_reaches_nothing_but_its_numbers(tmp_path, line, field):
    file = tmp_path / "stranger.toml"
    file.write_text(f'title = "t"\nsource = "s"\nlicence = "l"\nassumed = []\n{line}', encoding="utf-8")
    with pytest.raises(BadInput, match=field):
        read_case(file)
    assert loa("validate", str(file)).exit_code == EXIT_BAD_INPUT


@pytest.mark.parametrize("name", ["pairs:analyze", "pairs:no_such", "sector_series:root_stress"])
def test_a_function_that_is_not_made_for_cases_is_not_called(name):
    case = read_case(CASES["nafems_cylinder"]).model_copy(
        update={"function": f"lineofaction.validation.computed.{name}", "arguments": {}}
    )
    outcome = run_case(case, no_verb)
    assert outcome.failed
    assert "a function that lineofaction.validation.computed." in outcome.reason


def test_damaged_files_end_in_one_error(tmp_path):
    """Cuts, exchanged lines, other bytes and deep or long tables of a case of the program, by seed."""
    text, draw = CASES["rikor_forces"].read_bytes(), Random(20261130)
    for number in range(100):
        damaged = bytearray(text)
        for _ in range(draw.randrange(1, 6)):
            place = draw.randrange(len(damaged))
            damaged[place : place + draw.randrange(40)] = draw.randbytes(draw.randrange(12))
        file = tmp_path / f"damaged_{number}.toml"
        file.write_bytes(bytes(damaged))
        with suppress(BadInput):
            run_case(read_case(file), no_verb)
