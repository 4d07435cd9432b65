"""What a run of the tests has, and what it leaves to the nightly run."""

import shutil
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
import suite_selection
from suite_selection import LONG, ROOT, SLOW, TESTS, digest, heed_named_files, houses_from, rests_on, select

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
def on_record(monkeypatch):
    """Have a slow test on record, and what it rested on; the caller may change that."""
    passed = {"tests/unit/scripts/test_suite_selection.py": digest(HERE)}
    monkeypatch.setattr(suite_selection, "read_costs", lambda: {SLOW_TEST: SLOW + 0.1})
    monkeypatch.setattr(suite_selection, "read_passed", lambda: passed)
    return passed


@pytest.mark.usefixtures("on_record")
def test_a_slow_test_that_passed_is_left_and_all_others_run():
    assert _left([_item("slow"), _item("quick"), _item("new")]) == ["slow"]


@pytest.mark.usefixtures("on_record")
def test_a_slow_law_runs():
    assert _left([_item("slow", "law")]) == []


def test_a_long_law_runs_when_what_it_rests_on_changed(on_record, monkeypatch):
    monkeypatch.setattr(suite_selection, "read_costs", lambda: {SLOW_TEST: LONG + 0.1})
    assert _left([_item("slow", "law")]) == ["slow"]
    on_record.clear()
    assert _left([_item("slow", "law")]) == []


@pytest.mark.usefixtures("on_record")
@pytest.mark.parametrize(("cost", "left"), [(LONG - 0.1, []), (LONG + 0.1, ["sharing", "sharing too"])])
def test_a_dear_fixture_counts_for_each_test_that_shares_it(monkeypatch, cost, left):
    monkeypatch.setattr(suite_selection, "read_costs", lambda: {SLOW_TEST.replace("slow", "table"): cost})
    assert _left([_item("sharing", "law"), _item("sharing too"), _item("quick")]) == left


def test_a_chain_runs_whole_or_not_at_all(on_record, monkeypatch):
    costs = {SLOW_TEST: SLOW - 0.1, f"{SLOW_TEST}_too": 0.2}
    monkeypatch.setattr(suite_selection, "read_costs", lambda: costs)
    chain = [_item("slow", "chain"), _item("slow_too", "chain"), _item("quick")]
    assert _left(chain) == ["slow", "slow_too"]
    assert _left([_item("slow", "chain"), _item("slow_too")]) == []
    on_record.clear()
    assert _left(chain) == []


CASES = [f"case[{number}]" for number in range(7)]


@pytest.mark.parametrize("turn", range(5))
def test_of_cases_that_are_slow_by_their_sum_a_fifth_runs(on_record, monkeypatch, turn):
    costs = {SLOW_TEST.replace("slow", name): 0.6 * SLOW for name in CASES}
    monkeypatch.setattr(suite_selection, "read_costs", lambda: costs)
    monkeypatch.setattr(suite_selection, "turn", lambda: turn)
    for marks in ((), ("law",)):
        left = _left([_item("quick[0]"), _item("quick[1]"), *(_item(name, *marks) for name in CASES)])
        assert len(left) in (5, 6) and set(left) < set(CASES)
    assert _left([_item(name) for name in CASES[:1]]) == []
    assert _left([_item(name, "drawn") for name in CASES]) == []
    on_record.clear()
    assert _left([_item(name) for name in CASES]) == []


@pytest.mark.usefixtures("on_record")
def test_a_case_of_the_night_is_not_drawn_in_place_of_one_of_the_day(monkeypatch):
    costs = {SLOW_TEST.replace("slow", name): 0.6 * SLOW for name in CASES}
    monkeypatch.setattr(suite_selection, "read_costs", lambda: costs)
    day, night = CASES[:2], CASES[2:]
    for turn in range(5):
        monkeypatch.setattr(suite_selection, "turn", lambda turn=turn: turn)
        left = _left([_item(name) for name in day] + [_item(name, "nightly") for name in night])
        assert len(left) == 1 and left[0] in day


@pytest.mark.usefixtures("on_record")
def test_everything_runs_on_request():
    assert _left([_item("slow")], all=True) == []


@pytest.mark.parametrize("day", [False, True])
def test_a_file_that_is_named_runs_whole_in_workers_too(monkeypatch, day):
    monkeypatch.setenv("PYTEST_XDIST_WORKER", "gw0")
    option = SimpleNamespace(all=False, day=day)
    named = SimpleNamespace(
        args_source=pytest.Config.ArgsSource.ARGS, option=option, getoption=vars(option).get
    )
    heed_named_files(named)
    assert option.all != day


def test_a_slow_test_runs_when_what_it_rests_on_changed(on_record):
    on_record.update(dict.fromkeys(on_record, "another"))
    assert _left([_item("slow")]) == []
    assert _left([_item("slow")], day=True) == ["slow"]
    on_record.clear()
    assert _left([_item("slow")]) == []


@pytest.mark.usefixtures("on_record")
def test_a_house_has_the_tests_of_itself_and_of_what_stands_on_it(monkeypatch):
    houses = frozenset({"lineofaction.report"})
    monkeypatch.setattr(suite_selection, "rests_on", lambda _file: (frozenset({HERE}), houses))
    assert _left([_item("quick")], house="gearbox") == []
    assert _left([_item("quick")], house="service") == ["quick"]
    assert "lineofaction.cli" in houses_from("dynamics") and "fe_contact" not in houses_from("dynamics")
    with pytest.raises(
        pytest.UsageError, match="gearboxes: no house; there are verification, cli, hardcases"
    ):
        houses_from("gearboxes")


def test_a_test_rests_on_what_it_and_its_fakes_import():
    files, houses = rests_on(TESTS / "unit" / "dynamics" / "bearings" / "test_matrix.py")
    assert houses == {"dynamics", "model_studies", "bounds", "host"}
    assert {file.name for file in files} >= {"test_matrix.py"}
    assert rests_on(HERE)[1] == set()


def test_a_test_rests_on_the_houses_below_those_it_imports():
    _, houses = rests_on(TESTS / "stability" / "test_hard_scenes.py")
    assert houses >= {"lineofaction.hardcases", "lineofaction.gearbox", "dynamics", "fe_contact", "host"}
    assert "lineofaction.cli" not in houses


def test_a_test_of_references_rests_on_what_they_import():
    _, houses = rests_on(TESTS / "unit" / "verification" / "full_contact" / "test_line_loads.py")
    assert houses == {"verification", "fe_contact", "model_studies", "bounds", "host"}


def test_a_test_that_starts_processes_rests_on_all_houses():
    assert rests_on(TESTS / "flow" / "test_manual.py")[1] == set(suite_selection.structure.HOUSES)


def test_the_digest_follows_every_file_of_a_house(monkeypatch, tmp_path):
    of_house = suite_selection._of_house.__wrapped__
    before = of_house("bounds")
    shutil.copytree(ROOT / "bounds", tmp_path / "bounds", ignore=shutil.ignore_patterns("__pycache__"))
    monkeypatch.setattr(suite_selection, "ROOT", tmp_path)
    copied = of_house("bounds")
    (tmp_path / "bounds" / "page.html").write_text("new")
    assert copied == before != of_house("bounds")


@pytest.fixture
def page_test(monkeypatch, tmp_path):
    """Return a test that rests on itself, a folder of pages and `versions`, which both have a file."""
    monkeypatch.setattr(suite_selection, "ROOT", tmp_path)
    monkeypatch.setattr(suite_selection, "VERSIONS", tmp_path / "versions")
    monkeypatch.setattr(suite_selection, "rests_on", lambda file: (frozenset({file}), frozenset()))
    (tmp_path / "pages" / "inner").mkdir(parents=True)
    (tmp_path / "pages" / "inner" / "page.md").write_text("one")
    (tmp_path / "versions").write_text("1")
    test = tmp_path / "test_pages.py"
    test.write_text('RESTS_ON = ("pages", "versions")')
    return test


def test_the_digest_follows_what_a_file_names_and_versions(page_test):
    digests = {digest.__wrapped__(page_test)}
    for name, text in (("pages/inner/page.md", "two"), ("versions", "2")):
        (page_test.parent / name).write_text(text)
        digests.add(digest.__wrapped__(page_test))
    assert len(digests) == 3


def test_the_digest_is_blind_to_bytecode(page_test):
    before = digest.__wrapped__(page_test)
    compiled = page_test.parent / "pages" / "inner" / "__pycache__" / "page.cpython-312.pyc"
    compiled.parent.mkdir()
    compiled.write_bytes(b"of this interpreter")
    assert digest.__wrapped__(page_test) == before


def test_a_path_that_is_not_there_is_refused(page_test):
    page_test.write_text('RESTS_ON = ("sheets",)')
    with pytest.raises(pytest.UsageError, match=r"test_pages\.py: RESTS_ON names sheets, which is not there"):
        digest.__wrapped__(page_test)


@pytest.mark.parametrize(
    "line",
    [
        "from spur_gears import pinion",
        "import spur_gears",
        "import tests.fakes.spur_gears as gears",
        "from tests.fakes import spur_gears",
        "from tests.fakes.spur_gears import pinion",
    ],
)
def test_a_test_rests_on_a_fake_however_it_is_imported(tmp_path, line):
    test = tmp_path / "test_gears.py"
    test.write_text(f"{line}\nimport structure")
    assert {TESTS / "fakes" / "spur_gears.py", ROOT / "scripts" / "structure.py"} <= rests_on(test)[0]


@pytest.mark.parametrize("line", ["import lineofaction as loa", "from lineofaction import analyze"])
def test_a_test_of_the_public_names_rests_on_all_houses(tmp_path, line):
    test = tmp_path / "test_public.py"
    test.write_text(line)
    assert rests_on(test)[1] == set(suite_selection.structure.HOUSES)


def test_a_day_takes_changed_files_up_to_its_budget_those_that_cost_least_first(monkeypatch):
    files = ["tests/conftest.py", "tests/api/test_traces.py", "tests/flow/test_main_job.py"]
    dear, half = 2.0 * suite_selection.BUDGET, 0.5 * suite_selection.BUDGET
    costs = dict(zip((f"{name}::test" for name in files), (dear, half, 0.4 * dear), strict=True))
    monkeypatch.setattr(suite_selection, "read_costs", lambda: costs)
    monkeypatch.setattr(suite_selection, "read_passed", lambda: dict.fromkeys(files, "another"))
    assert suite_selection.left_to_the_night.__wrapped__() == {files[0], files[2]}
