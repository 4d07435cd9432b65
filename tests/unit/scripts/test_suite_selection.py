"""What a run of the tests has, and what it leaves to the nightly run."""

from __future__ import annotations

import shutil
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
import suite_selection
from suite_selection import ROOT, TESTS, digest, heed_named_files, houses_from, rests_on, select

HERE = Path(__file__)
SLOW_TEST = "tests/unit/scripts/test_suite_selection.py::slow"


class _Item(SimpleNamespace):
    def get_closest_marker(self, name: str) -> bool:
        return name in self.marks


def _item(name: str, *marks: str) -> Any:
    nodeid = f"tests/unit/scripts/test_suite_selection.py::{name}"
    return _Item(nodeid=nodeid, path=HERE, marks=marks, fixturenames=["table"] * name.startswith("sharing"))


def _left(items: list[Any], **options: Any) -> list[str]:
    """Return the names of what a run leaves out."""
    left: list[Any] = []
    hook = SimpleNamespace(pytest_deselected=lambda items: left.extend(items))  # noqa: PLW0108
    config: Any = SimpleNamespace(
        getoption={"all": False, "day": False, "house": None, **options}.__getitem__, hook=hook
    )
    everything = list(items)
    select(items, config)
    assert [item for item in everything if item not in left] == items
    return [item.nodeid.partition("::")[2] for item in left]


@pytest.fixture
def on_record(monkeypatch: pytest.MonkeyPatch) -> dict[str, str]:
    """Have a slow test on record, and what it rested on; the caller may change that."""
    passed = {"tests/unit/scripts/test_suite_selection.py": digest(HERE)}
    monkeypatch.setattr(suite_selection, "read_costs", lambda: {SLOW_TEST: 1.1})
    monkeypatch.setattr(suite_selection, "read_passed", lambda: passed)
    return passed


@pytest.mark.usefixtures("on_record")
def test_a_slow_test_that_passed_is_left_and_all_others_run() -> None:
    assert _left([_item("slow"), _item("quick"), _item("new")]) == ["slow"]


@pytest.mark.usefixtures("on_record")
def test_a_slow_law_runs() -> None:
    assert _left([_item("slow", "law")]) == []


def test_a_long_law_runs_when_what_it_rests_on_changed(
    on_record: dict[str, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(suite_selection, "read_costs", lambda: {SLOW_TEST: 3.1})
    assert _left([_item("slow", "law")]) == ["slow"]
    on_record.clear()
    assert _left([_item("slow", "law")]) == []


@pytest.mark.usefixtures("on_record")
@pytest.mark.parametrize(("cost", "left"), [(2.9, []), (3.1, ["sharing", "sharing too"])])
def test_a_dear_fixture_counts_for_each_test_that_shares_it(
    monkeypatch: pytest.MonkeyPatch, cost: float, left: list[str]
) -> None:
    monkeypatch.setattr(suite_selection, "read_costs", lambda: {SLOW_TEST.replace("slow", "table"): cost})
    assert _left([_item("sharing", "law"), _item("sharing too"), _item("quick")]) == left


def test_a_chain_runs_whole_or_not_at_all(on_record: dict[str, str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(suite_selection, "read_costs", lambda: {SLOW_TEST: 0.9, f"{SLOW_TEST}_too": 0.2})
    chain = [_item("slow", "chain"), _item("slow_too", "chain"), _item("quick")]
    assert _left(chain) == ["slow", "slow_too"]
    assert _left([_item("slow", "chain"), _item("slow_too")]) == []
    on_record.clear()
    assert _left(chain) == []


@pytest.mark.usefixtures("on_record")
def test_everything_runs_on_request() -> None:
    assert _left([_item("slow")], all=True) == []


@pytest.mark.parametrize("day", [False, True])
def test_a_file_that_is_named_runs_whole_in_workers_too(monkeypatch: pytest.MonkeyPatch, day: bool) -> None:
    monkeypatch.setenv("PYTEST_XDIST_WORKER", "gw0")
    option = SimpleNamespace(all=False, day=day)
    named = SimpleNamespace(
        args_source=pytest.Config.ArgsSource.ARGS, option=option, getoption=vars(option).get
    )
    heed_named_files(named)  # type: ignore[arg-type]
    assert option.all != day


def test_a_slow_test_runs_when_what_it_rests_on_changed(on_record: dict[str, str]) -> None:
    on_record.update(dict.fromkeys(on_record, "another"))
    assert _left([_item("slow")]) == []
    assert _left([_item("slow")], day=True) == ["slow"]
    on_record.clear()
    assert _left([_item("slow")]) == []


@pytest.mark.usefixtures("on_record")
def test_a_house_has_the_tests_of_itself_and_of_what_stands_on_it(monkeypatch: pytest.MonkeyPatch) -> None:
    houses = frozenset({"lineofaction.report"})
    monkeypatch.setattr(suite_selection, "rests_on", lambda _file: (frozenset({HERE}), houses))
    assert _left([_item("quick")], house="gearbox") == []
    assert _left([_item("quick")], house="service") == ["quick"]
    assert "lineofaction.cli" in houses_from("dynamics") and "fe_contact" not in houses_from("dynamics")
    with pytest.raises(pytest.UsageError, match="gearboxes: no house; there are cli, hardcases"):
        houses_from("gearboxes")


def test_a_test_rests_on_what_it_and_its_fakes_import() -> None:
    files, houses = rests_on(TESTS / "unit" / "dynamics" / "bearings" / "test_matrix.py")
    assert houses == {"dynamics", "model_studies", "bounds", "host"}
    assert {file.name for file in files} >= {"test_matrix.py"}
    assert rests_on(HERE)[1] == set()


def test_a_test_rests_on_the_houses_below_those_it_imports() -> None:
    _, houses = rests_on(TESTS / "stability" / "test_hard_scenes.py")
    assert houses >= {"lineofaction.hardcases", "lineofaction.gearbox", "dynamics", "fe_contact", "host"}
    assert "lineofaction.cli" not in houses


def test_a_test_that_starts_processes_rests_on_all_houses() -> None:
    assert rests_on(TESTS / "flow" / "test_manual.py")[1] == set(suite_selection.structure.HOUSES)


def test_the_digest_follows_every_file_of_a_house(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    of_house = suite_selection._of_house.__wrapped__
    before = of_house("bounds")
    shutil.copytree(ROOT / "bounds", tmp_path / "bounds", ignore=shutil.ignore_patterns("__pycache__"))
    monkeypatch.setattr(suite_selection, "ROOT", tmp_path)
    copied = of_house("bounds")
    (tmp_path / "bounds" / "page.html").write_text("new")
    assert copied == before != of_house("bounds")


def test_the_digest_follows_what_a_file_names_and_versions(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(suite_selection, "ROOT", tmp_path)
    versions, page = tmp_path / "versions", tmp_path / "pages" / "inner" / "page.md"
    monkeypatch.setattr(suite_selection, "VERSIONS", versions)
    page.parent.mkdir(parents=True)
    test = tmp_path / "test_pages.py"
    test.write_text('RESTS_ON = ("pages", "versions")')
    monkeypatch.setattr(suite_selection, "rests_on", lambda file: (frozenset({file}), frozenset()))
    seen = set()
    for version, text in (("1", "one"), ("1", "two"), ("2", "two")):
        versions.write_text(version)
        page.write_text(text)
        seen.add(digest.__wrapped__(test))
    assert len(seen) == 3
