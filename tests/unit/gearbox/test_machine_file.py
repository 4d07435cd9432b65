"""Curve files of measuring machines say the same of a gear as its sheet; every line has its fate."""

import numpy as np
import pytest
from command_line import printed
from damaged_text import fates_of_a_hundred
from machine_texts import CHART, GEAR, TEETH, machine_text
from spur_case import spur_case

from lineofaction.gearbox.inspection.machine_file import OTHER_TRACE, OUTSIDE, UNKNOWN, UNMEASURED
from lineofaction.gearbox.inspection.machine_heading import STATEMENTS
from lineofaction.gearbox.inspection.measured_gear import Chart, MeasuredGear, inspected, measured_gear
from lineofaction.gearbox.inspection.reading import read_sheet
from lineofaction.gearbox.inspection.sheet import sheet_text
from lineofaction.gearbox.problems import BadInput


def taken(text: str, chart: Chart) -> MeasuredGear:
    return measured_gear(read_sheet(text, GEAR, "gear.mka"), chart, "gear.mka")


@pytest.mark.law
@pytest.mark.parametrize("loaded", ["left", "right"])
@pytest.mark.parametrize("separate", [True, False], ids=["titles above", "titles beside"])
@pytest.mark.parametrize("counting", [0, 1], ids=["clockwise", "counterclockwise"])
def test_a_machine_says_the_same_of_a_gear_as_its_sheet(loaded, separate, counting):
    chart = Chart(GEAR, loaded, True)
    points = list(inspected(chart))
    of_sheet = taken(sheet_text(points), chart)
    text = machine_text(chart, separate, counting).replace("\n", "\r\n")
    of_machine = taken(f"\ufeff{text}", chart)
    assert of_machine.fields["pitch_deviation_um"] == pytest.approx(
        of_sheet.fields["pitch_deviation_um"], abs=2e-5
    )
    assert of_machine.splits.keys() == of_sheet.splits.keys()
    for (tooth, name), of_machine_trace in of_machine.splits.items():
        of_sheet_trace = of_sheet.splits[tooth, name]
        places = of_sheet_trace.coordinate
        assert of_machine_trace.coordinate == pytest.approx(places, abs=1e-8)
        surfaces = [
            trace.rest + trace.slope * (places - places.mean()) / trace.length
            for trace in (of_machine_trace, of_sheet_trace)
        ]
        first, second = (surface - surface.mean() for surface in surfaces)
        assert first == pytest.approx(second, abs=1e-10)
        values = [point.deviation for point in points if (point.tooth, point.trace) == (tooth, name)]
        slope = np.polyfit(np.linspace(0.0, 1.0, len(values)), values, 1)[0]
        length = of_machine_trace.length / (places[-1] - places[0])
        assert of_machine_trace.slope == pytest.approx(slope * length, abs=1e-10)
    assert of_machine.omitted == []


def test_what_else_a_machine_writes_is_accounted_for():
    text = machine_text(CHART)
    before = taken(text, CHART).account
    # tooth 19 clockwise is the third that a machine meets
    head = "Zahn-Nr.: 3 rechts / 61  Werte  z= 7.5\n"
    start = text.index(head) + len(head)
    text = text[:start] + "-2147483.648" + text[text.index(" ", start) :]
    text += (
        "Verschränkung: Zahn-Nr.: 1k /Flankenlinie:3 links / 2  Werte  x= 10.263\n 1.0 2.0\n"
        "Fußkreisdurchmesser / Höhe :     7.500\n   49.5 49.6\n"
        "Teilung:\nZ-Nr. Seite PHI X Y Z\n  1   R  0.0000  .1198  25.5249  87.2302\n"
        "ein Satz\n"
    )
    done = taken(text, CHART)
    gained = {fate: count - before.get(fate, 0) for fate, count in done.account.items()}
    gained = {fate: count for fate, count in gained.items() if count}
    assert gained == {
        OTHER_TRACE: 2,
        UNMEASURED: 1,
        UNKNOWN: 1,
        "heading": 1,
        "other table or heading": 4,
        "profile": -1,
    }
    assert len(done.omitted) == 3


def test_points_beyond_the_evaluated_range_are_left_to_the_probe():
    """A tenth of 61 points at either end of two profiles and two helices; slopes stay whole-width."""
    whole, part = (taken(machine_text(CHART, part=part), CHART) for part in (0.0, 0.1))
    assert part.account[OUTSIDE] == 4 * 2 * 6
    assert part.omitted == []
    for key, split in part.splits.items():
        if key[1] == "helix":
            assert split.length == pytest.approx(25e-3)
        else:
            assert split.length == pytest.approx(0.8 * whole.splits[key].length, rel=1e-6)


@pytest.mark.parametrize(
    ("of", "by", "said"),
    [
        (
            "22 :Zähnezahl z.........: 20",
            "22 :Zähnezahl z.........: 21",
            "of a gear of 20 teeth; line 13 has 21",
        ),
        ("mn [mm]..:  4.000", "mn [mm]..:  3.000", "of module 4 mm; line 14 has 3"),
        ("...da  [mm]", "...dx  [mm]", "whose heading has da, d1, d2, de [mm]"),
        (
            "Start Messbereich......da  [mm]..:  ",
            "Start Messbereich......da  [mm]..:  1e-9  1e-9 ",
            "with da [mm] of one or both flanks; line 15 has",
        ),
        ("Zahn-Nr.: 3 rechts / 61  Werte  z", "Zahn-Nr.: 33 rechts / 61  Werte  z", "of teeth from 1 to 20"),
        (
            "Zahn-Nr.: 3 rechts / 61  Werte  z",
            "Zahn-Nr.: 3 rechts / 62  Werte  z",
            "of 62 values in the trace of line",
        ),
        (
            "Zahn-Nr.: 3 rechts / 61  Werte  z",
            "Zahn-Nr.: 3 rechts / 999999  Werte  z",
            "values in the trace of line",
        ),
        ("\n  2  ", "\n  3  ", "the pitches of teeth 1 to 20 in turn"),
        ("\n  20  ", "\n  21  ", "the pitches of teeth 1 to 20 in turn"),
        ("ZRICH: 1", "ZRICH: 2", "direction of counting, line 161 of the heading) is 0 (clockwise) or 1"),
        ("ZRICH: 1", "ZRICH: 2", "(counterclockwise); line 24 has '2'"),
        ("UNITS mm", "UNITS inch", "is mm (millimeters); line 3 has 'inch'"),
        ("LVORZ: 1: DIN", "LVORZ: 0: VDI", "line 29 has '0:VDI'"),
        (" 161 :", " 161 :again :ZRICH: 0\n 161 :", "lines 24 and 25 differ"),
        ("UNDEFINED -2147483.648", "UNDEFINED -", "a file with UNDEFINED and a number"),
    ],
)
def test_a_file_is_refused_by_what_is_wrong(of, by, said):
    text = machine_text(CHART)
    assert of in text
    with pytest.raises(BadInput) as caught:
        taken(text.replace(of, by), CHART)
    assert said in str(caught.value)


@pytest.mark.parametrize("name", STATEMENTS)
def test_a_heading_without_one_of_its_conventions_is_refused_by_its_name(name):
    """Nothing is assumed: each convention that decides how values are read must stand in the file."""
    lines = [line for line in machine_text(CHART).splitlines() if f":{name}:" not in line]
    lines = [line for line in lines if not line.startswith((f"{name} ", f"{name}:"))]
    with pytest.raises(BadInput, match=f"whose {name} .*it has none"):
        taken("\n".join(lines), CHART)


@pytest.mark.parametrize("separate", [True, False], ids=["titles above", "titles beside"])
def test_a_hundred_damaged_files_are_refused_once_or_accounted_for(separate, monkeypatch):
    fates = fates_of_a_hundred(machine_text(CHART, separate), lambda text: taken(text, CHART), monkeypatch)
    assert min(fates["taken"], fates["refused"]) >= 10, fates


@pytest.mark.parametrize(
    "attack",
    [
        "HEADER KS.MK.FILE\n" + "Profil:\n" * 100_000,
        "HEADER KS.MK.FILE\n" + "Zahn-Nr.: 1 links / 999999 Werte z= 1\n" * 1000,
        "HEADER KS.MK.FILE\n" + " " * 1_000_000 + "x",
        "HEADER KS.MK.FILE\n" + " 1 :" + "a" * 1_000_000 + ":",
        "HEADER KS.MK.FILE\n" + " 1 :da [mm]: " + "9" * 1_000_000,
        "HEADER KS.MK.FILE\n" + " 1 :" + "da [mm]." * 100_000,
        "HEADER KS.MK.FILE\n" + " 1 :" + ": ABC " * 100_000,
        "HEADER KS.MK.FILE\n" + "linke Zahnflanke\n" + "1 1 1 1\n" * 100_000,
    ],
    ids=["titles", "traces", "blanks", "label", "digits", "symbols", "names", "rows"],
)
def test_a_hostile_file_is_one_error(attack):
    with pytest.raises(BadInput):
        taken(attack, CHART)


def test_the_verb_takes_the_file_of_a_machine(tmp_path):
    case, file = tmp_path / "case.toml", tmp_path / "gear.mka"
    case.write_text(spur_case(torques=[100.0]), encoding="utf-8")
    file.write_text(machine_text(CHART), encoding="utf-8")
    done = printed("measured", case, file, "--gear", "pinion", "--loaded", "right")
    assert {trace["tooth"] for trace in done["traces"]} == {2, 19}
    assert len(done["fields"]["pitch_deviation_um"]) == TEETH
