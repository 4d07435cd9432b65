"""Faults of a file name its line, and what is expected there."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from lineofaction.cli.commands import app
from lineofaction.gearbox.input_file import InputFile, Override
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas import Case, read_model
from lineofaction.gearbox.schemas.reading import _line_of

EXAMPLES = Path(__file__).parents[3] / "examples"
SPUR = EXAMPLES / "palermo_spur_20_20.toml"


def fields(value: Any, path: str = "") -> Iterator[tuple[str, str]]:
    if isinstance(value, dict):
        for name, inner in value.items():
            yield from fields(inner, f"{path}.{name}".lstrip("."))
    elif isinstance(value, list) and value and isinstance(value[0], dict):
        for index, inner in enumerate(value):
            yield from fields(inner, f"{path}[{index}]")
    else:
        yield path, path.rpartition(".")[2]


@pytest.mark.parametrize("file", sorted(EXAMPLES.glob("*.toml")), ids=lambda file: file.stem)
def test_every_field_of_an_example_is_found_in_a_line_that_names_it(file: Path) -> None:
    text = file.read_text(encoding="utf-8")
    lines = text.splitlines()
    seen: dict[str, int] = {}
    for path, name in fields(tomllib.loads(text)):
        number = _line_of(text, path)
        assert number is not None, path
        if name in lines[number - 1]:
            own = lines[number - 1].split("=")[0].strip() == name
            assert not own or number not in seen.values(), path  # a line of its own
            seen[path] = number if own else -1
        else:  # of an inline table, which begins further up
            table = path.removesuffix(f".{name}").rpartition(".")[2].partition("[")[0]
            assert table in lines[number - 1], path
    assert len([number for number in seen.values() if number > 0]) > 0.5 * len(seen)


def test_texts_and_lists_of_several_lines_hide_what_looks_like_a_field() -> None:
    text = (
        'a = """\nb = 1\n[c]\n"""\nd = [\n  1,\n  2, # ]\n]\n"e f" = 3\n'
        "[c]\nb = 4\n[[g.h]]\nx = 1\n[[g.h]]\nx = 2\n"
    )
    expected = {"a": 1, "d": 5, "c.b": 11, "g.h[0].x": 13, "g.h[1].x": 15, "c.missing": 10, "b": None}
    assert {path: _line_of(text, path) for path in expected} == expected


def changed(tmp_path: Path, old: str, new: str) -> Path:
    text = SPUR.read_text(encoding="utf-8")
    assert old in text
    file = tmp_path / "case.toml"
    file.write_text(text.replace(old, new), encoding="utf-8")
    return file


def errors(*arguments: object) -> list[str]:
    done = CliRunner().invoke(app, [str(argument) for argument in arguments])
    assert done.exit_code == 2
    return done.stderr.strip().splitlines()


def test_a_value_out_of_bounds_a_wrong_name_and_an_impossible_gear_name_their_line(tmp_path: Path) -> None:
    wrong = changed(tmp_path, "[pair.wheel]\nteeth = 20", "[pair.wheel]\nteeth = 3")
    (line,) = errors("plan", wrong)
    assert line.startswith("error: pair.wheel.teeth = 3: must be")
    assert line.endswith(f" ({wrong}:16)")
    misspelled = changed(tmp_path, "poissons_ratio", "poisons_ratio")
    (line,) = errors("plan", misspelled)
    assert line.endswith(f"Did you mean poissons_ratio? ({misspelled}:22)")
    impossible = changed(
        tmp_path, "bore_diameter_mm = 40.0\n\n[pair.wheel]", "bore_diameter_mm = 75.0\n[pair.wheel]"
    )
    for verb in ("plan", "geometry", "flank"):
        (line,) = errors(verb, impossible)
        assert line.startswith("error: pair.pinion.bore_diameter_mm = 75.0"), verb
        assert line.endswith(f" ({impossible}:13)"), verb


def test_a_line_that_is_no_toml_is_shown_with_what_is_expected(tmp_path: Path) -> None:
    (line,) = errors("plan", changed(tmp_path, 'level = "standard"', "level = standard"))
    assert "= 'level = standard': must be well-formed TOML, which line 29 is not" in line
    assert "a text in quotes" in line


def test_a_value_that_was_set_is_in_no_line() -> None:
    with pytest.raises(BadInput) as error:
        read_model(Case, InputFile(SPUR, (Override("pair.pinion.teeth", 2.5),)))
    assert [fault.place for fault in error.value.faults] == [""]


def test_json_over_http_stays_as_it_was(tmp_path: Path) -> None:
    with pytest.raises(BadInput) as error:
        read_model(Case, changed(tmp_path, "teeth = 20", "teeth = 2.5"))
    assert set(error.value.faults[0].as_json()) == {"field", "value", "bound", "suggestion"}
