"""The pages say what the code does: every field, path, verb, setting and exit code is in them."""

import inspect
import re
from pathlib import Path

import pytest
import service_pages
from described_api import DESCRIPTION
from pydantic import BaseModel

from lineofaction.cli.commands import app as loa
from lineofaction.gearbox import problems
from lineofaction.gearbox.registry import STUDIES
from lineofaction.gearbox.schemas import bearings, bodies, case, gear, housings, loads, meshes, scene
from service.settings import Settings, load_settings

DOCS = Path(__file__).parents[3] / "docs"


def page(name: str) -> str:
    return (DOCS / name).read_text(encoding="utf-8")


def models() -> list[type[BaseModel]]:
    modules = (case, gear, scene, bearings, bodies, housings, loads, meshes)
    found = [vars(module).values() for module in modules]
    return [m for group in found for m in group if inspect.isclass(m) and issubclass(m, BaseModel)]


def test_every_field_of_case_and_scene_is_documented():
    documented = set(re.findall(r"[`.]([a-z][a-z0-9_]+)`", page("case-file.md")))
    tables = {"pair", "pinion", "wheel", "load", "errors", "accuracy", "effects", "run", "shafts", "gears"}
    tables |= {"discs", "bushings", "rolling_bearings", "meshes", "drives", "loads", "outputs", "integration"}
    tables |= {"free_rotations", "housings", "planets", "planet_bearings", "couplings", "speed_torques"}
    tables |= {"forces", "unbalances", "temperatures", "complaint", "report"}
    fields = {name for model in models() for name in model.model_fields} - tables
    assert fields - documented == set()
    for table in tables:
        assert re.search(rf"\[\[?(pair\.)?{table}\]|{table}\.", page("case-file.md")), table


def test_every_path_is_documented():
    text = service_pages.with_routes(page("service.md"), lambda: DESCRIPTION)
    text = text.replace("{hash}", "{key}").replace("{id}", "{job_id}")
    for path in DESCRIPTION["paths"]:
        generic = re.sub(r"/processes/([a-z-]+|\{process_id\})", "/processes/{job_id}", path)
        assert generic in text, path


def test_every_verb_and_exit_code_is_documented():
    text = page("cli.md")
    verbs = [verb.name or verb.callback.__name__ for verb in loa.registered_commands]
    studies = page("studies.md")
    for name in (*verbs, *STUDIES):
        assert f"`loa {name}" in (studies if name in STUDIES else text), name
    for name, code in vars(problems).items():
        if name.startswith("EXIT_"):
            assert f"\n| {code} |" in text, name


def test_every_setting_is_documented_with_its_default():
    rows = page("operations.md").splitlines()
    for name, field in Settings.model_fields.items():
        (entry,) = [row for row in rows if row.startswith(f"| `LOA_{name.upper()}`")]
        if isinstance(field.default, int | float):
            assert f"{field.default:.15g}" in entry.replace(" ", "")


@pytest.mark.parametrize(
    ("name", "value"),
    [("port", 70_000), ("workers", 0), ("queue_limit", -1), ("attempts", 0)],
)
def test_a_setting_out_of_bounds_is_said_by_name(name, value):
    with pytest.raises(problems.BadInput) as caught:
        load_settings(**{name: value})
    assert [fault.field for fault in caught.value.faults] == [name]


def test_settings_come_from_the_environment_and_arguments_win(monkeypatch):
    monkeypatch.setenv("LOA_PORT", "1234")
    monkeypatch.setenv("LOA_WORKERS", "3")
    assert (load_settings().port, load_settings(port=99, host=None).port) == (1234, 99)
    assert load_settings().workers == 3
