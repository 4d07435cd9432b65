"""Curve files of measuring machines say the same of a gear as its sheet; every line has its fate."""

from __future__ import annotations

from pathlib import Path

import pytest
from command_line import printed
from damaged_text import fates_of_a_hundred
from machine_texts import CHART, GEAR, TEETH, machine_text
from spur_case import spur_case

from lineofaction.gearbox.inspection.machine_file import OTHER_TRACE, UNKNOWN, UNMEASURED
from lineofaction.gearbox.inspection.measured_gear import Chart, MeasuredGear, inspected, measured_gear
from lineofaction.gearbox.inspection.reading import read_sheet
from lineofaction.gearbox.inspection.sheet import Flank, sheet_text
from lineofaction.gearbox.problems import BadInput


def taken(text: str, chart: Chart) -> MeasuredGear:
    return measured_gear(read_sheet(text, GEAR, "gear.mka"), chart, "gear.mka")


@pytest.mark.law
@pytest.mark.parametrize("loaded", ["left", "right"])
@pytest.mark.parametrize("separate", [True, False], ids=["titles above", "titles beside"])
def test_a_machine_says_the_same_of_a_gear_as_its_sheet(loaded: Flank, separate: bool) -> None:
    chart = Chart(GEAR, loaded, True)
    of_sheet = taken(sheet_text(inspected(chart)), chart)
    text = machine_text(chart, separate).replace("\n", "\r\n")
    of_machine = taken(f"\ufeff{text}", chart)
    assert of_machine.fields["pitch_deviation_um"] == pytest.approx(
        of_sheet.fields["pitch_deviation_um"], abs=2e-5
    )
    assert of_machine.splits.keys() == of_sheet.splits.keys()
    for key, one in of_sheet.splits.items():
        other = of_machine.splits[key]
        assert other.coordinate == pytest.approx(one.coordinate, abs=1e-8)
        assert (other.slope, other.form) == pytest.approx((one.slope, one.form), abs=1e-10)
    assert of_machine.omitted == []


def test_what_else_a_machine_writes_is_accounted_for() -> None:
    text = machine_text(CHART)
    before = taken(text, CHART).account
    text = text.replace(
        "Zahn-Nr.: 19 rechts / 61  Werte  z= 7.5\n", "Zahn-Nr.: 19 rechts / 61  Werte  z= 7.5\n-2147483.648 "
    )
    first = text.index("-2147483.648 ", text.index("z= 7.5")) + len("-2147483.648 ")
    text = text[:first] + text[text.index(" ", first) + 1 :]
    text += (
        "Verschränkung: Zahn-Nr.: 1k /Flankenlinie:3 links / 2  Werte  x= 10.263\n 1.0 2.0\n"
        "Fußkreisdurchmesser / Höhe :     7.500\n   49.5 49.6\n"
        "Teilung:\nZ-Nr. Seite PHI X Y Z\n  1   R  0.0000  .1198  25.5249  87.2302\n"
        "ein Satz\n"
    )
    found = taken(text, CHART)
    gained = {fate: count - before.get(fate, 0) for fate, count in found.account.items()}
    gained = {fate: count for fate, count in gained.items() if count}
    assert gained == {
        OTHER_TRACE: 2,
        UNMEASURED: 1,
        UNKNOWN: 1,
        "heading": 1,
        "other table or heading": 4,
        "profile": -1,
    }
    assert len(found.omitted) == 3


@pytest.mark.parametrize(
    ("of", "by", "said"),
    [
        (
            "22 :Zähnezahl z.........: 20",
            "22 :Zähnezahl z.........: 21",
            "of a gear of 20 teeth; line 6 has 21",
        ),
        ("mn [mm]..:  4.000", "mn [mm]..:  3.000", "of module 4 mm; line 7 has 3"),
        ("...da  [mm]", "...d1  [mm]", "whose heading has da [mm]"),
        (
            "Start Messbereich......da  [mm]..:  ",
            "Start Messbereich......da  [mm]..:  1e-9  1e-9 ",
            "of diameters from 75.1754 mm on",
        ),
        ("Zahn-Nr.: 19 rechts / 61  Werte  z", "Zahn-Nr.: 33 rechts / 61  Werte  z", "of teeth from 1 to 20"),
        (
            "Zahn-Nr.: 19 rechts / 61  Werte  z",
            "Zahn-Nr.: 19 rechts / 62  Werte  z",
            "of 62 values in the trace of line",
        ),
        (
            "Zahn-Nr.: 19 rechts / 61  Werte  z",
            "Zahn-Nr.: 19 rechts / 999999  Werte  z",
            "values in the trace of line",
        ),
        ("  2  0.1  ", "  3  0.1  ", "the pitches of teeth 1 to 20 in turn"),
        ("  20  0.1  ", "  21  0.1  ", "the pitches of teeth 1 to 20 in turn"),
    ],
)
def test_a_file_is_refused_by_what_is_wrong(of: str, by: str, said: str) -> None:
    text = machine_text(CHART)
    assert of in text
    with pytest.raises(BadInput) as caught:
        taken(text.replace(of, by), CHART)
    assert said in str(caught.value)


def test_a_hundred_damaged_files_are_refused_once_or_accounted_for(monkeypatch: pytest.MonkeyPatch) -> None:
    fates = fates_of_a_hundred(machine_text(CHART), lambda text: taken(text, CHART), monkeypatch)
    assert min(fates["taken"], fates["refused"]) >= 10, fates


@pytest.mark.parametrize(
    "attack",
    [
        "HEADER KS.MK.FILE\n" + "Profil:\n" * 100_000,
        "HEADER KS.MK.FILE\n" + "Zahn-Nr.: 1 links / 999999 Werte z= 1\n" * 1000,
        "HEADER KS.MK.FILE\n" + " " * 1_000_000 + "x",
        "HEADER KS.MK.FILE\n" + " 1 :" + "a" * 1_000_000 + ":",
        "HEADER KS.MK.FILE\n" + " 1 :da [mm]: " + "9" * 1_000_000,
        "HEADER KS.MK.FILE\n" + "linke Zahnflanke\n" + "1 1 1 1\n" * 100_000,
    ],
    ids=["titles", "traces", "blanks", "label", "digits", "rows"],
)
def test_a_hostile_file_is_one_error(attack: str) -> None:
    with pytest.raises(BadInput):
        taken(attack, CHART)


def test_the_verb_takes_the_file_of_a_machine(tmp_path: Path) -> None:
    case, file = tmp_path / "case.toml", tmp_path / "gear.mka"
    case.write_text(spur_case(torques=[100.0]), encoding="utf-8")
    file.write_text(machine_text(CHART), encoding="utf-8")
    done = printed("measured", case, file, "--gear", "pinion", "--loaded", "right")
    assert {trace["tooth"] for trace in done["traces"]} == {2, 19}
    assert len(done["fields"]["pitch_deviation_um"]) == TEETH
