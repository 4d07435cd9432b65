"""A folder in place of a file: verbs find what they take in it and leave their results there."""

import json
import os
import shutil
from pathlib import Path

import pytest
from command_line import loa, printed
from repository import EXAMPLES
from scene_files import scene_file
from spur_case import spur_case

from lineofaction.gearbox.input_file import InputFile
from lineofaction.gearbox.problems import EXIT_BAD_INPUT, BadInput
from lineofaction.gearbox.project import (
    file_of,
    inputs_in,
    result_name,
    results_by_part,
    results_in,
    status_of,
    tables_in,
)
from lineofaction.gearbox.registry import STUDIES


@pytest.fixture
def rotor(tmp_path):
    """A folder with a scene under another name, and files that are none of the program's."""
    folder = tmp_path / "rotor"
    folder.mkdir()
    shutil.copy(EXAMPLES / "jeffcott_scene.toml", folder / "jeffcott.toml")
    (folder / "notes.json").write_text("[1, 2]")
    (folder / "broken.toml").write_text("[[shafts")
    (folder / "latin.toml").write_bytes(b"name = '\xe9'")
    (folder / "folder.toml").mkdir()
    (folder / "gone.toml").symlink_to(folder / "nothing.toml")
    os.mkfifo(folder / "pipe.toml")
    (folder / "deep.json").write_text("[" * 100_000)
    return folder


def test_a_folder_stands_for_the_scene_in_it_whatever_lies_beside(rotor):
    assert file_of(InputFile(rotor), "scene") == InputFile(rotor / "jeffcott.toml", (), rotor)
    assert file_of(InputFile(rotor), "case or scene").path == rotor / "jeffcott.toml"
    with pytest.raises(BadInput, match="must be a folder with a case file in it"):
        file_of(InputFile(rotor), "case")


def test_of_several_the_one_of_that_name_is_taken_and_none_is_guessed(rotor):
    shutil.copy(rotor / "jeffcott.toml", rotor / "stiffer.toml")
    with pytest.raises(BadInput, match=r"Name one: .*jeffcott\.toml, .*stiffer\.toml"):
        file_of(InputFile(rotor), "scene")
    shutil.copy(rotor / "jeffcott.toml", rotor / "scene.toml")
    assert file_of(InputFile(rotor), "scene").path == rotor / "scene.toml"


def test_the_file_of_a_study_is_known_by_its_fields(rotor):
    assert inputs_in(rotor, STUDIES["deflect"]) is None
    (rotor / "loads.toml").write_text("[[load_cases]]\nname = 'one'\n")
    assert inputs_in(rotor, STUDIES["deflect"]) == rotor / "loads.toml"
    shutil.copy(rotor / "loads.toml", rotor / "others.toml")
    with pytest.raises(BadInput, match=r"one file for deflect. Name one: .*loads\.toml, .*others\.toml"):
        inputs_in(rotor, STUDIES["deflect"])


def test_speeds_that_are_not_named_go_up_to_the_highest_of_drive_and_load_cases(tmp_path):
    scene = scene_file(tmp_path)  # at 900 rpm
    assert printed("response", scene, "--orders", 1)["speed_rpm"] == pytest.approx(
        [1.5 * k for k in range(1, 601)]
    )
    cases = "[[load_cases]]\nname = 'fast'\nspeed_rpm = 6000.0\n[[load_cases]]\nname = 'as it is'\n"
    (tmp_path / "cases.toml").write_text(cases)
    assert printed("response", tmp_path, "--orders", 1)["speed_rpm"] == pytest.approx(
        [10.0 * k for k in range(1, 601)]
    )
    assert (tmp_path / "response.nc").is_file()
    assert printed("modes", tmp_path, "--orders", 1)["speed_rpm"] == []
    (tmp_path / "others.toml").write_text("[[load_cases]]\nname = 'faster'\nspeed_rpm = 9000.0\n")
    assert printed("response", tmp_path, "--orders", 1)["speed_rpm"][-1] == pytest.approx(9000.0)
    (tmp_path / "others.toml").write_text("[[load_cases]]\nname = 'faster'\nspeed_rpm = -9000.0\n")
    refused = loa("response", tmp_path)
    assert refused.exit_code == EXIT_BAD_INPUT
    assert "load_cases[0].speed_rpm = -9000.0: must be above 0" in refused.stderr
    assert "others.toml:3" in refused.stderr


def test_a_study_over_speeds_says_what_to_name_where_nothing_turns(rotor):
    file = rotor / "jeffcott.toml"
    file.write_text(file.read_text("utf-8").replace("speed_rpm = [3843.5]", "speed_rpm = [0.0]"))
    for verb in ("noise", "vibration", "response", "steady"):
        refused = loa(verb, rotor)
        assert refused.exit_code == EXIT_BAD_INPUT
        assert "must be given where neither a drive nor a load case has a speed. For" in refused.stderr


def states(folder: Path) -> dict[str, str]:
    return {one.name: one.state for one in status_of(folder)}


def test_a_result_lies_in_the_folder_and_is_stale_once_its_scene_is_newer(rotor):
    assert set(states(rotor).values()) == {"missing"}
    done = loa("modes", rotor, "--speed-rpm", "0:3000:1500")
    assert done.exit_code == 0, done.output
    assert done.stdout.splitlines()[-1] == f"written to {rotor / 'modes.nc'}"
    assert states(rotor)["modes.nc"] == "fresh"
    assert states(rotor)["response.nc"] == "missing"
    made = (rotor / "modes.nc").stat().st_mtime
    os.utime(rotor / "jeffcott.toml", (made + 1.0, made + 1.0))
    assert states(rotor)["modes.nc"] == "stale"


def test_a_report_of_a_folder_has_all_results_in_it(rotor):
    assert loa("modes", rotor, "--speed-rpm", "0:3000:1500").exit_code == 0
    (rotor / "sub").mkdir()
    shutil.move(rotor / "modes.nc", rotor / "sub" / "modes.nc")
    assert results_in(rotor) == [rotor / "sub" / "modes.nc"]
    done = loa("report", rotor)
    assert done.exit_code == 0, done.output
    assert "lowest natural frequency" in (rotor / "report.html").read_text("utf-8")


@pytest.mark.parametrize("verb", ["analyze", "simulate"])
def test_without_a_folder_an_output_is_asked_for(verb):
    file = EXAMPLES / ("palermo_spur_20_20.toml" if verb == "analyze" else "jeffcott_scene.toml")
    done = loa(verb, file)
    assert done.exit_code == EXIT_BAD_INPUT
    assert "Give one with -o, or name a folder to work in" in done.output


def test_the_status_is_json_too_and_a_folder_of_nothing_says_so(rotor, tmp_path):
    rows = json.loads(loa("status", rotor, "--json").stdout)["results"]
    (noise,) = (row for row in rows if row["verb"] == "noise")
    assert (noise["name"], noise["state"], noise["cpu_seconds"]) == ("noise.nc", "missing", None)
    (steady,) = (row["cpu_seconds"] for row in rows if row["verb"] == "steady")
    assert steady > 0.0
    empty = tmp_path / "empty"
    empty.mkdir()
    for folder, bound in ((empty, "a folder with a case or scene file in it"), (tmp_path / "no", "a folder")):
        done = loa("status", folder)
        assert done.exit_code == EXIT_BAD_INPUT
        assert f"must be {bound}" in done.output


def test_the_status_refuses_nothing_that_is_there_and_says_what_lacks(rotor):
    """A complaint that options stated was fresh and refused, noise without a surface not predicted."""
    (rotor / "complaint.nc").touch()
    lines = loa("status", rotor).stdout.splitlines()
    of_verb = {line.partition("loa ")[2].split(" ")[0]: line.split() for line in lines if ".nc  " in line}
    assert (of_verb["complaint"][0], of_verb["complaint"][-1]) == ("fresh", "-")
    assert of_verb["noise"][-1] == of_verb["vibration"][-1] == "refused"
    assert "refused by loa noise: housings = []: must be at least one with a surface" in lines
    os.utime(rotor / "complaint.nc", (1.0, 1.0))
    assert "refused by loa complaint: complaint = nothing: must be given" in loa("status", rotor).stdout


@pytest.fixture
def unit(rotor):
    """A folder with two cases and load cases beside its scene."""
    for stage in ("first", "second"):
        (rotor / f"{stage}.toml").write_text(spur_case(torques=[100.0]))
    (rotor / "loads.toml").write_text("[[load_cases]]\nname = 'one'\n")
    return rotor


VERBS = {
    "plan": ("plan.run_plan", ["first.toml", "second.toml"]),
    "geometry": ("data_sheet.run_geometry", ["first.toml", "second.toml"]),
    "analyze": ("analyze.run_analyze", ["first.toml", "second.toml"]),
    "simulate": ("simulate.run_simulate", ["jeffcott.toml"]),
    "measured --gear pinion --loaded left": ("measured.run_measured", ["first.toml", "second.toml"]),
    "housing case.step --material cast_aluminum": ("housing.run_housing", ["jeffcott.toml"]),
}
STUDIED = {"flank": "case", "sweep --over torque": "case", "sensitivity": "both"} | dict.fromkeys(
    (
        "deflect",
        "modes",
        "response --speed-rpm 600",
        "noise --speed-rpm 600",
        "ablate",
        "steady --speed-rpm 600",
    ),
    "scene",
)


@pytest.mark.parametrize("words", VERBS)
def test_a_verb_takes_a_folder_and_does_each_of_its_cases(words, unit, monkeypatch):
    (function, expected), (verb, *options) = VERBS[words], words.split()
    done: list[str] = []
    monkeypatch.setattr(f"lineofaction.cli.{function}", lambda file, *_, **__: done.append(file.path.name))
    said = loa(verb, unit, *options)
    assert said.exit_code == 0
    assert done == expected
    assert said.stdout.split() == ([name.removesuffix(".toml") for name in expected] if expected[1:] else [])


@pytest.mark.parametrize("words", STUDIED)
def test_a_study_takes_a_folder_and_names_its_result_by_the_case(words, unit, monkeypatch):
    done: list[list[str]] = []

    def study(study, options):
        files = options[study.argument] if study.several else [options[study.argument]]
        done.append([f"{file.path.name}: {result_name(study, file.part)}" for file in files])

    monkeypatch.setattr("lineofaction.cli.run_study.run_study", study)
    verb, *options = words.split()
    assert loa(verb, unit, *options).exit_code == 0
    own = result_name(STUDIES[verb])
    by_case = [f"{stage}.toml: {stage}_{own}" for stage in ("first", "second")]
    subjects = {"scene": [[f"jeffcott.toml: {own}"]], "case": [[line] for line in by_case], "both": [by_case]}
    assert done == subjects[STUDIED[words]]


def test_one_object_or_one_file_is_of_one_case(unit):
    for options in (("--json",), ("-o", unit / "ste.nc")):
        done = loa("analyze", unit, *options)
        assert done.exit_code == EXIT_BAD_INPUT
        assert "must be a folder of one case. Name one:" in done.output


def test_results_are_told_apart_by_the_case_whose_name_they_bear(unit):
    for name in ("modes", "first", "first_flank", "second_flank", "firstly"):
        (unit / f"{name}.nc").touch()
    by_part = {part: [path.stem for path in paths] for part, paths in results_by_part(unit).items()}
    assert by_part == {
        "": ["firstly", "modes"],
        "first": ["first", "first_flank"],
        "second": ["second_flank"],
    }
    assert tables_in(unit, lambda case: case.with_suffix(".nc")) == {
        "first": unit / "first.nc",
        "second": None,
    }
    kept = unit / "modes.nc"
    assert tables_in(unit, lambda _: kept) == {"first": unit / "first.nc", "second": kept}


def test_the_status_says_what_a_result_would_cost_or_that_nothing_predicts_it(unit):
    (unit / "jeffcott.toml").unlink()
    facts = json.loads(loa("status", unit, "--json").stdout)
    seconds = {row["name"]: row["cpu_seconds"] for row in facts["results"]}
    assert facts["tables_cpu_seconds"] == 0.0  # no scene
    assert seconds["first.nc"] > seconds["first_flank.nc"] > 0.0
    assert seconds["first_scatter.nc"] > seconds["first.nc"]
    assert seconds["first_ablate.nc"] > 0.0
    first = {name for name in seconds if name.startswith("first")}
    assert {name.replace("first", "second") for name in first} == {
        n for n in seconds if n.startswith("second")
    }
    assert {name for name, cost in seconds.items() if cost is None}


def test_the_status_says_why_a_verb_would_refuse(tmp_path):
    """Once for a case that cannot be used, with its line; that of a file that cannot be read, too."""
    text = (EXAMPLES / "palermo_spur_20_20.toml").read_text()
    (tmp_path / "case.toml").write_text(text.replace("teeth = 20", "teeth = 2", 1))
    (tmp_path / "search.toml").write_text("[variables.pinion\n")
    lines = loa("status", tmp_path).stdout.splitlines()
    assert all(line.endswith("refused") for line in lines if line.startswith("missing"))
    reason = next(line for line in lines if "pair.pinion.teeth = 2: must be" in line)
    assert reason.startswith("refused by loa analyze and ")
    assert f"{tmp_path / 'case.toml'}:" in reason
    assert str(tmp_path / "search.toml") in lines[-1]
    assert "well-formed TOML" in lines[-1]
    facts = json.loads(loa("status", tmp_path, "--json").stdout)
    assert all("pair.pinion.teeth = 2" in row["refused"] for row in facts["results"])
    (tmp_path / "case.toml").unlink()
    alone = loa("status", tmp_path)
    assert alone.exit_code == 2
    assert "well-formed TOML" in alone.stderr
