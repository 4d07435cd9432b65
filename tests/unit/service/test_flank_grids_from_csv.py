"""Free-form flanks of a case: read from CSV beside a file, inline over HTTP, refused by place."""

from __future__ import annotations

import copy
import random
from pathlib import Path
from typing import Any

import pytest
from bad_inputs import GOOD
from spur_case import spur_case

from lineofaction.gearbox.convert.case import case_json, check_case, gear_pair
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas import Case, read_model, validated
from lineofaction.gearbox.schemas.scene import SceneInput

HEADING = "roll_length_mm,face_position_mm,removed_um"
ROWS = [f"{roll},{face},{roll * face / 10}" for roll in (4.5, 10, 19) for face in (-12.5, 0, 12.5)]
CASE = (
    spur_case('flank_grid_csv = "flanks/pinion.csv"')
    + """
[load]
torque_n_m = [100.0]
"""
)


def written(folder: Path, *lines: str) -> Path:
    """Write a case file and its CSV file; return the case file."""
    (folder / "flanks").mkdir()
    (folder / "flanks" / "pinion.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
    file = folder / "case.toml"
    file.write_text(CASE, encoding="utf-8")
    return file


def test_a_file_is_read_beside_the_case_whatever_the_order_of_its_rows(tmp_path: Path) -> None:
    shuffled = random.Random(3).sample(ROWS, len(ROWS))
    case = read_model(Case, written(tmp_path, "\ufeff# measured", HEADING, "", *shuffled))
    grid = gear_pair(case).pinion.modification.flank_grid
    assert grid is not None
    assert grid.roll_length == pytest.approx((4.5e-3, 10e-3, 19e-3), rel=1e-12, abs=0.0)
    assert grid.face_position == pytest.approx((-12.5e-3, 0.0, 12.5e-3), rel=1e-12, abs=1e-18)
    assert grid.removed[2] == pytest.approx((-23.75e-6, 0.0, 23.75e-6), rel=1e-12, abs=1e-18)
    assert gear_pair(case).wheel.modification.flank_grid is None


def test_columns_may_fake_any_order(tmp_path: Path) -> None:
    turned = [",".join(line.split(",")[::-1]) for line in (HEADING, *ROWS)]
    (tmp_path / "a").mkdir()
    (tmp_path / "b").mkdir()
    cases = [
        read_model(Case, written(tmp_path / name, *lines))
        for name, lines in (("a", (HEADING, *ROWS)), ("b", turned))
    ]
    assert cases[0] == cases[1]


def test_the_echo_holds_the_grid_itself_and_needs_no_file(tmp_path: Path) -> None:
    case = read_model(Case, written(tmp_path, HEADING, *ROWS))
    echo = case_json(case)
    assert "flank_grid_csv" not in echo["pair"]["pinion"]
    assert echo["pair"]["pinion"]["flank_grid"]["roll_length_mm"] == [4.5, 10.0, 19.0]
    assert case_json(validated(Case, echo)) == echo


def test_a_grid_of_a_case_inside_a_scene_is_found(tmp_path: Path) -> None:
    written(tmp_path, HEADING, *ROWS)
    nested = CASE.replace("[pair", "[meshes.case.pair").replace("[load]", "[meshes.case.load]")
    (tmp_path / "scene.toml").write_text('[[meshes]]\nname = "m"\n' + nested, encoding="utf-8")
    with pytest.raises(BadInput) as caught:
        read_model(SceneInput, tmp_path / "scene.toml")
    assert not [fault for fault in caught.value.faults if "case" in fault.field]
    (tmp_path / "flanks" / "pinion.csv").unlink()
    with pytest.raises(BadInput) as caught:
        read_model(SceneInput, tmp_path / "scene.toml")
    assert caught.value.faults[0].field == "meshes[0].case.pair.pinion.flank_grid_csv.file"


def test_a_client_cannot_name_a_file() -> None:
    table = copy.deepcopy(GOOD)
    table["pair"]["pinion"]["flank_grid_csv"] = "/etc/passwd"
    with pytest.raises(BadInput) as caught:
        validated(Case, table)
    (fault,) = caught.value.faults
    assert fault.field == "pair.pinion.flank_grid_csv"
    assert fault.bound.startswith("left out")


@pytest.mark.parametrize(
    ("lines", "said"),
    [
        ([], "it is empty"),
        ([HEADING.replace("_um", "_mm"), *ROWS], HEADING),
        ([HEADING.replace(",", ";"), *ROWS], "with commas"),
        (
            [HEADING, *ROWS[:-1]],
            "1 of 9 nodes are missing, the first at roll_length_mm = 19, face_position_mm",
        ),
        ([HEADING, *ROWS, ROWS[0]], "line 11 repeats"),
        ([HEADING, *ROWS[:-1], "19,12.5,"], "line 10 holds nothing in removed_um"),
        ([HEADING, *ROWS[:-1], "19,nan,1"], "line 10 holds 'nan' in face_position_mm"),
        ([HEADING, *ROWS[:-1], "19,12.5"], "line 10 has 2"),
    ],
)
def test_a_file_that_holds_no_grid_is_refused_by_what_is_wrong(
    tmp_path: Path, lines: list[str], said: str
) -> None:
    with pytest.raises(BadInput) as caught:
        read_model(Case, written(tmp_path, *lines))
    (fault,) = caught.value.faults
    assert fault.field == "pair.pinion.flank_grid_csv"
    assert said in fault.bound


@pytest.mark.parametrize(
    ("change", "field"),
    [
        ({"roll_length_mm": [19.0, 4.0]}, "roll_length_mm"),
        ({"removed_um": [[0.0, 0.0], [1.0]]}, "removed_um[1]"),
        ({"removed_um": [[0.0, 0.0], [1.0, 2000.0]]}, "removed_um[1][1]"),
        ({"removed_um": [[0.0, 0.0], [1.0, float("nan")]]}, "removed_um[1][1]"),
        ({"face_position_mm": [20.0, 30.0]}, "face_position_mm"),
        ({"face_position_mm": [0.0]}, "face_position_mm"),
    ],
)
def test_an_inline_grid_is_refused_by_the_cases_names(change: dict[str, Any], field: str) -> None:
    table = copy.deepcopy(GOOD)
    grid = {"roll_length_mm": [4.0, 19.0], "face_position_mm": [-5.0, 5.0], "removed_um": [[0, 0], [1, 2]]}
    table["pair"]["pinion"]["flank_grid"] = grid | change
    with pytest.raises(BadInput) as caught:
        check_case(validated(Case, table))
    assert caught.value.faults[0].field.startswith(f"pair.pinion.flank_grid.{field}")


def test_a_grid_that_differs_over_the_face_is_no_matter_of_the_plane() -> None:
    table = copy.deepcopy(GOOD) | {"accuracy": {"model": "plane_strain"}}
    grid = {"roll_length_mm": [4.0, 19.0], "face_position_mm": [-5.0, 5.0], "removed_um": [[0, 0], [2, 2]]}
    table["pair"]["pinion"]["flank_grid"] = grid
    check_case(validated(Case, table))
    grid["removed_um"] = [[0, 0], [1, 2]]
    with pytest.raises(BadInput) as caught:
        check_case(validated(Case, table))
    assert caught.value.faults[0].field == "pair.pinion.flank_grid.removed_um"
