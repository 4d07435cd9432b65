"""Tables of force waves as CSV: rows in any order and unit give one table, and hostile text is refused."""

import random

import numpy as np
import pytest

from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas.named_files import read_text
from lineofaction.gearbox.studies.force_waves import table_file
from lineofaction.gearbox.studies.force_waves.table_file import force_wave_table

HEADING = (
    "temporal_order,spatial_order,speed_rpm,torque_n_m,radial_pressure_kpa,radial_phase_deg,"
    "tangential_pressure_kpa,tangential_phase_deg"
)
ROWS = [
    f"{k},{r},{speed},{torque},{1 + k},{10 * r},{0.5 + 0.1 * k},{-speed / 100}"
    for k, r in ((0, 0), (8, 2), (48, -1))
    for speed in (1000, 3000)
    for torque in (0, 100, 200)
]
GOOD = "\n".join((HEADING, *ROWS))


def test_a_table_is_in_si_with_phases():
    table = force_wave_table(GOOD, "table")
    np.testing.assert_array_equal(table.temporal_order, [0, 8, 48])
    np.testing.assert_array_equal(table.spatial_order, [0, 2, -1])
    np.testing.assert_allclose(table.speed, np.array([1000, 3000]) * np.pi / 30.0)
    np.testing.assert_array_equal(table.torque, [0.0, 100.0, 200.0])
    assert table.radial[1, 0, 2] == pytest.approx(9e3 * np.exp(1j * np.radians(20.0)))
    assert table.tangential[2, 1, 0] == pytest.approx(5.3e3 * np.exp(-1j * np.radians(30.0)))


def test_order_of_rows_and_columns_comments_and_blank_lines_are_free():
    shuffled = ROWS.copy()
    random.Random(3).shuffle(shuffled)
    columns = random.Random(4).sample(range(8), 8)
    moved = [",".join(line.split(",")[c] for c in columns) for line in (HEADING, *shuffled)]
    table = force_wave_table("\ufeff# ein Motor, µ\r\n" + "\r\n\r\n".join(moved), "table")
    np.testing.assert_array_equal(table.radial, force_wave_table(GOOD, "table").radial)


@pytest.mark.parametrize(
    ("old", "new", "factor"),
    [
        ("kpa", "pa", 1e-3),
        ("kpa", "mpa", 1e3),
        ("phase_deg", "phase_rad", None),
        ("speed_rpm", "speed_hz", None),
    ],
)
def test_the_ending_of_a_column_is_its_unit(old, new, factor):
    table, other = force_wave_table(GOOD, "table"), force_wave_table(GOOD.replace(old, new), "table")
    if factor:
        np.testing.assert_allclose(np.abs(other.radial), factor * np.abs(table.radial))
    elif "hz" in new:
        np.testing.assert_allclose(other.speed, 60.0 * table.speed)
    else:
        assert other.radial[1, 0, 0] == pytest.approx(9e3 * np.exp(20j))


def with_cell(column, text, row=0):
    cells = ROWS[row].split(",")
    cells[HEADING.split(",").index(column)] = text
    return "\n".join((HEADING, *ROWS[:row], ",".join(cells), *ROWS[row + 1 :]))


BAD_CELLS = [
    ("temporal_order", "-8", "temporal orders >= 0"),
    ("temporal_order", "1.5", "whole orders"),
    ("temporal_order", "8e0", "whole orders"),
    ("temporal_order", "99999", "whole orders up to 10000"),
    ("temporal_order", "1" * 5000, "whole orders"),
    ("temporal_order", "", "whole orders"),
    ("spatial_order", "0.5", "whole orders"),
    ("spatial_order", "-10001", "whole orders"),
    ("spatial_order", "nan", "whole orders"),
    ("spatial_order", "٣", "whole orders"),
    ("speed_rpm", "-1", "speeds >= 0"),
    ("speed_rpm", "nan", "finite numbers"),
    ("speed_rpm", "inf", "finite numbers"),
    ("speed_rpm", "1_000", "finite numbers"),
    ("torque_n_m", "1e999", "finite numbers"),
    ("torque_n_m", "0x10", "finite numbers"),
    ("torque_n_m", "１２", "finite numbers"),
    ("radial_pressure_kpa", "-1", "amplitudes from 0"),
    ("radial_pressure_kpa", "1e6", "amplitudes from 0 to 100 MPa"),
    ("radial_pressure_kpa", "1e308", "finite numbers"),
    ("radial_pressure_kpa", "NaN", "finite numbers"),
    ("radial_phase_deg", "1e9", "100 turns"),
    ("tangential_phase_deg", "-", "finite numbers"),
    ("tangential_pressure_kpa", "=cmd()", "finite numbers"),
    ("tangential_pressure_kpa", "\x00", "finite numbers"),
]


@pytest.mark.parametrize(("column", "text", "said"), BAD_CELLS)
def test_a_cell_is_refused_by_its_line(column, text, said):
    with pytest.raises(BadInput) as caught:
        force_wave_table(with_cell(column, text, row=4), "table")
    assert said in str(caught.value) and "line 6" in str(caught.value) and "table" in str(caught.value)
    assert len(str(caught.value)) < 400


BAD_TEXTS = [
    ("", "it is empty"),
    ("# a comment", "it is empty"),
    (HEADING, "a heading alone"),
    (GOOD.replace("temporal_order,", "order,"), "columns of temporal_order"),
    (GOOD.replace("radial_pressure_kpa", "radial_pressure"), "columns of radial_pressure"),
    (GOOD.replace("radial_pressure_kpa", "radial_pressure_psi"), "unit of pressure"),
    (GOOD.replace("radial_pressure_kpa", "radial_pressure_n_m"), "unit of pressure"),
    (GOOD.replace("torque_n_m", "torque_mm"), "unit of torque"),
    (GOOD.replace("torque_n_m", "torque_lbf_ft"), "unit of torque"),
    (GOOD.replace("speed_rpm", "speed_n_m"), "unit of speed"),
    (GOOD.replace("radial_phase_deg", "radial_phase_rpm"), "unit of angle"),
    (GOOD.replace("tangential_phase_deg", "radial_phase_rad"), "one column of radial_phase"),
    (GOOD.replace("spatial_order", "temporal_order"), "columns of spatial_order"),
    (f"{HEADING},spare\n" + "\n".join(f"{row},1" for row in ROWS), "nothing else"),
    (f"{HEADING},speed_rpm\n" + "\n".join(f"{row},1" for row in ROWS), "one column of speed"),
    (GOOD.replace(",", ";"), "columns of"),
    (f"{GOOD}\n{ROWS[3]}", "line 20 repeats one"),
    (f"{GOOD}\n{ROWS[3].replace('1000', '1e3')}", "repeats one"),
    ("\n".join((HEADING, *ROWS[:-1])), "1 of 18 rows are missing"),
    ("\n".join((HEADING, *ROWS[:7], *ROWS[8:])), "temporal order 8, spatial order 2"),
    (f"{GOOD}\n1,2,3", "line 20 has 3"),
    (f'{GOOD}\n"1,2,3', "line 20"),
]


@pytest.mark.parametrize(("text", "said"), BAD_TEXTS)
def test_a_text_that_is_no_table_is_refused(text, said):
    with pytest.raises(BadInput) as caught:
        force_wave_table(text, "table")
    assert said in str(caught.value)


def test_a_static_pattern_against_the_rotor_is_refused_everywhere():
    text = "\n".join([HEADING, "0,-2,0,0,1,0,1,0"])
    with pytest.raises(BadInput, match="opposite phase"):
        force_wave_table(text, "table")


def test_too_many_rows_and_too_many_characters_are_refused(monkeypatch):
    monkeypatch.setattr(table_file, "MAX_ROWS", 17)
    with pytest.raises(BadInput, match="at most 17"):
        force_wave_table(GOOD, "table")
    monkeypatch.setattr(table_file, "MAX_CHARACTERS", 100)
    with pytest.raises(BadInput, match="at most 100 characters"):
        force_wave_table(GOOD, "table")


def test_a_grid_that_is_all_diagonal_is_refused_without_being_laid_out():
    """20000 rows of different waves, speeds and torques would be a grid of 8e12."""
    rows = (f"{n % 9000 + 1},{n // 9000},{n},{n},1,0,1,0" for n in range(20_000))
    with pytest.raises(BadInput, match="a complete grid"):
        force_wave_table("\n".join((HEADING, *rows)), "table")


@pytest.mark.parametrize(
    "content",
    [
        GOOD.encode("utf-16"),
        GOOD.encode() + "\n# größe".encode("latin-1"),
        GOOD.encode() + "\n# ".encode("utf-16-le") + b"\xff\xfe",
        b"\x89HDF\r\n\x1a\n" + bytes(range(256)),
    ],
)
def test_a_file_in_another_or_in_two_encodings_is_refused(tmp_path, content):
    file = tmp_path / "motor.csv"
    file.write_bytes(content)
    with pytest.raises(BadInput, match="UTF-8"):
        force_wave_table(read_text(file, "motor.csv"), "table")
