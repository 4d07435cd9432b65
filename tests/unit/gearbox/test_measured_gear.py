"""Sheets of an inspection: every line has its fate, and what a case holds comes back from its sheet."""

import json
import math
import tomllib
from dataclasses import replace

import numpy as np
import pytest
from command_line import loa, printed
from damaged_text import fates_of_a_hundred
from spur_case import spur_case

from fe_contact.geometry import Gear, PitchDeviation, RingGear, ToothFlank, Toothing
from lineofaction.gearbox.convert.case import gear_pair
from lineofaction.gearbox.inspection.as_made import Inspected, measured_case
from lineofaction.gearbox.inspection.evaluation import gaussian, split
from lineofaction.gearbox.inspection.measured_gear import Chart, MeasuredGear, inspected, measured_gear
from lineofaction.gearbox.inspection.reading import read_sheet
from lineofaction.gearbox.inspection.sheet import Flank, sheet_text
from lineofaction.gearbox.problems import EXIT_WARNINGS, BadInput
from lineofaction.gearbox.schemas import Case, read_model, validated

TEETH = 20
FLANKS = (ToothFlank(3, 4e-6, -2e-6, 2, -3e-6), ToothFlank(20, -1e-6, helix_form=3e-6))
PITCHES = PitchDeviation(tuple(1e-6 * np.random.default_rng(5).normal(0.0, 4.0, TEETH)))
PINION = Gear(TEETH, 4e-3, 25e-3, 40e-3, pitch_deviation=PITCHES, tooth_flanks=FLANKS)
RING = RingGear(60, 4e-3, 25e-3, 280e-3, addendum_coefficient=0.75, tooth_flanks=FLANKS)
HEAD = "tooth,flank,trace,roll_length_mm,face_position_mm,deviation_um"


def taken(text: str, gear: Toothing = PINION, loaded: Flank = "right", drives: bool = True) -> MeasuredGear:
    found = measured_gear(read_sheet(text, gear, "sheet.csv"), Chart(gear, loaded, drives), "sheet.csv")
    assert sum(found.account.values()) == len(text.splitlines())
    return found


def refused(text: str) -> str:
    with pytest.raises(BadInput) as caught:
        taken(text)
    (fault,) = caught.value.faults
    assert (fault.field, fault.value) == ("measured", "sheet.csv")
    return fault.bound


@pytest.mark.parametrize("gear", [PINION, RING], ids=["external", "internal"])
@pytest.mark.parametrize("loaded", ["left", "right"])
@pytest.mark.parametrize("drives", [True, False], ids=["drives", "driven"])
def test_an_inspection_gives_back_what_it_measured(gear, loaded, drives):
    chart = Chart(gear, loaded, drives)
    found = taken(sheet_text(inspected(chart)), gear, loaded, drives)
    cumulative = 1e6 * np.array(gear.pitch_deviation.cumulative)
    assert found.fields.get("pitch_deviation_um", []) == pytest.approx(cumulative, abs=1e-5)
    for entry, flank in zip(found.fields["tooth_flanks"], gear.tooth_flanks, strict=True):
        assert entry["tooth"] == flank.tooth
        slopes = entry["profile_slope_um"], entry["helix_slope_um"]
        assert slopes == pytest.approx((1e6 * flank.profile_slope, 1e6 * flank.helix_slope), abs=2e-2)


@pytest.mark.parametrize(
    ("gear", "loaded", "drives", "order", "sign"),
    [
        (PINION, "right", True, (1, 20, 19), 1),
        (PINION, "left", True, (1, 2, 3), -1),
        (PINION, "right", False, (1, 2, 3), 1),
        (PINION, "left", False, (1, 20, 19), -1),
        (RING, "right", False, (1, 60, 59), -1),
        (RING, "left", False, (1, 2, 3), 1),
    ],
)
def test_teeth_come_in_the_order_in_which_the_loaded_flanks_mesh(gear, loaded, drives, order, sign):
    """Clockwise on the sheet; a gear that drives by its right flanks turns clockwise, the next behind."""
    rows = [f"{tooth},{loaded},cumulative_pitch,,,{tooth}" for tooth in range(1, gear.teeth + 1)]
    found = taken("\n".join((HEAD, *rows)), gear, loaded, drives)
    assert found.fields["pitch_deviation_um"][:3] == [float(sign * tooth) for tooth in order]


def test_single_pitches_of_a_sheet_are_summed_clockwise():
    rows = [f"{tooth},right,pitch,,,{3 if tooth == 2 else 0}" for tooth in range(1, 21)]
    found = taken("\n".join((HEAD, *rows))).fields["pitch_deviation_um"]
    assert found[0] == pytest.approx(-0.15)  # tooth 1: the mean of all pitches is taken out
    assert found[-1] == pytest.approx(2.7)  # tooth 2, the last in mesh of a driving gear
    assert found[1] == pytest.approx(0.0)  # tooth 20 closes the circle


def test_the_filter_keeps_half_a_wave_of_its_cut_off_and_all_of_a_line():
    place = np.linspace(0.0, 20e-3, 2001)
    at = np.linspace(0.0, 20e-3, 41)
    line = 3e-6 + 2e-4 * place
    assert gaussian(place, line, at, 0.5e-3) == pytest.approx(line[::50], rel=1e-12)
    wave = np.cos(2.0 * math.pi * place / 0.5e-3)
    assert gaussian(place, wave, at, 0.5e-3)[2:-2] == pytest.approx(0.5 * wave[::50][2:-2], abs=1e-6)


def test_a_trace_is_split_into_its_line_and_the_height_of_the_rest():
    place = np.linspace(2e-3, 20e-3, 901)
    u = (place - 11e-3) / 9e-3
    found = split(place, 1e-6 + 2e-6 * u + 0.75e-6 * np.cos(2.0 * math.pi * u))
    assert found.slope == pytest.approx(4e-6, rel=2e-3)
    assert found.form == pytest.approx(1.5e-6, rel=2e-2)
    assert found.cutoff == pytest.approx(18e-3 / 30)


def test_places_are_taken_as_they_are_typed():
    """Roll angle, diameter and distance from the datum face are the same points by closed form."""
    radius, half = PINION.base_radius, 12.5
    rolls = np.linspace(4.0, 14.0, 61)
    rows = [(roll, face, math.sin(roll)) for roll, face in zip(rolls, np.linspace(-10, 10, 61), strict=True)]
    other = {
        "roll_angle_deg": [math.degrees(1e-3 * roll / radius) for roll in rolls],
        "diameter_mm": [2e3 * math.hypot(radius, 1e-3 * roll) for roll in rolls],
    }
    plain = taken("\n".join((HEAD, *(f"1,right,profile,{r:.12g},,{d:.9g}" for r, _, d in rows))))
    for column, values in other.items():
        text = [f"1,right,profile,{v:.12g},,{d:.9g}" for v, (_, _, d) in zip(values, rows, strict=True)]
        found = taken("\n".join((HEAD.replace("roll_length_mm", column), *text)))
        assert found.splits[1, "profile"].rest == pytest.approx(plain.splits[1, "profile"].rest, abs=1e-12)
    near = taken("\n".join((HEAD, *(f"1,right,helix,,{f:.12g},{d:.9g}" for _, f, d in rows))))
    text = [f"1,right,helix,,{f + half:.12g},{d:.9g}" for _, f, d in rows]
    far = taken("\n".join((HEAD.replace("face_position_mm", "face_distance_mm"), *text)))
    assert far.splits[1, "helix"].slope == pytest.approx(near.splits[1, "helix"].slope, rel=1e-9)


def test_a_topography_is_taken_whole_and_its_tooth_has_no_other_trace():
    nodes = [(roll, face) for roll in (4, 9, 14) for face in (-10, 0, 10)]
    rows = [f"5,right,topography,{roll},{face},{roll * face / 100}" for roll, face in nodes]
    found = taken("\n".join((HEAD, "# measured", "", *rows, "5,right,profile,5,,1", "5,left,profile,5,,1")))
    (entry,) = found.fields["tooth_flanks"]
    assert entry["flank_grid"]["removed_um"][2] == [1.4, 0.0, -1.4]
    assert found.account == {
        "heading": 1,
        "comment or blank": 2,
        "topography": 9,
        "left out: the tooth has a topography": 1,
        "left out: not the loaded flank": 1,
    }


@pytest.mark.law
def test_other_teeth_are_the_mean_of_the_measured_ones():
    """Figures of the gear and flanks of its teeth together: measured teeth keep their surface."""
    content = validated(Case, tomllib.loads(spur_case(torques=[100.0])))
    sheet = sheet_text(inspected(Chart(PINION, "right", True)))
    cases = [
        measured_case(content, sheet, "sheet.csv", Inspected("pinion", "right", None, mean))[0]
        for mean in (False, True)
    ]
    alone, about_mean = (gear_pair(case).pinion for case in cases)
    place = np.meshgrid(
        np.linspace(*sorted((alone.form_roll_length, alone.tip_roll_length)), 31),
        np.linspace(-12.5e-3, 12.5e-3, 31),
        indexing="ij",
    )

    def surface(gear, tooth):
        flanks = [flank.excess(gear, *place) for flank in gear.tooth_flanks if flank.tooth == tooth]
        return np.asarray(sum(flanks, -gear.modification.removed(gear, *place)))

    measured = [surface(alone, flank.tooth) for flank in FLANKS]
    for flank, excess in zip(FLANKS, measured, strict=True):
        assert surface(about_mean, flank.tooth) == pytest.approx(excess, abs=2e-8)
    assert surface(about_mean, 7) == pytest.approx(0.5 * (measured[0] + measured[1]), abs=2e-8)
    assert np.abs(measured[0] - measured[1]).max() > 1e-6
    assert surface(alone, 7) == pytest.approx(0.0, abs=1e-12)


def test_a_mean_needs_traces_of_the_same_kinds():
    rows = [f"{tooth},right,{kind}" for tooth, kind in ((1, "profile"), (2, "profile"), (2, "helix"))]
    places = {
        "profile": [f"{4 + 0.1 * k:.3f}," for k in range(100)],
        "helix": [f",{k / 10}" for k in range(-99, 100)],
    }
    text = [f"{row},{place},{k % 3}" for row in rows for k, place in enumerate(places[row.split(",")[2]])]
    sheet = read_sheet("\n".join((HEAD, *text)), PINION, "sheet.csv")
    with pytest.raises(BadInput, match="of the same kinds at the same places"):
        measured_gear(sheet, Chart(PINION, "right", True), "sheet.csv", mean_of_others=True)


PROFILE = [f"1,right,profile,{4 + 0.1 * k:.3f},,{k % 3}" for k in range(100)]


@pytest.mark.parametrize(
    ("lines", "said"),
    [
        ([], "empty"),
        ([HEAD], "heading alone"),
        ([HEAD.replace("deviation_um", "deviation_mm"), *PROFILE], "names each column once"),
        ([HEAD.replace("tooth,", ""), *PROFILE], "the column tooth"),
        ([HEAD + ",diameter_mm", *PROFILE], "one of the columns"),
        ([HEAD, *PROFILE[:-1], "1,right,profile,5"], "line 101 has 4"),
        ([HEAD, *PROFILE, PROFILE[3]], "line 102 repeats line 5"),
        ([HEAD, "21,right,profile,5,,1"], "teeth from 1 to 20; line 2"),
        ([HEAD, "1,top,profile,5,,1"], "left and right flanks; line 2"),
        ([HEAD, "1,right,lead,5,,1"], "the traces pitch"),
        ([HEAD, "1,right,profile,5,,nan"], "finite numbers; line 2"),
        ([HEAD, "1,right,profile,5,,2000"], "up to 1000 µm; line 2"),
        ([HEAD, *PROFILE[::20]], "at most the cut-off"),
        ([HEAD, *PROFILE[:2]], "a trace of 3 to"),
        ([HEAD, "1,right,pitch,,,1"], "19 are missing, the first is 2"),
        ([HEAD, "1,right,pitch,,,1", "1,right,cumulative_pitch,,,1"], "not both"),
        ([HEAD, "1,right,topography,5,1,1", "1,right,topography,6,2,1"], "lacks 2 points"),
        ([HEAD, '1,right,profile,5,,"' + 200_000 * "9"], "CSV"),
    ],
)
def test_a_sheet_is_refused_by_what_is_wrong(lines, said):
    assert said in refused("\n".join(lines))


def test_a_hundred_damaged_sheets_are_refused_once_or_accounted_for(monkeypatch):
    sound = sheet_text(inspected(Chart(replace(PINION, tooth_flanks=FLANKS[:1]), "right", True)))
    fates = fates_of_a_hundred(sound, taken, monkeypatch)
    assert min(fates["taken"], fates["refused"]) >= 10, fates


def test_the_verb_writes_a_sheet_and_takes_it_back(tmp_path):
    pitches = [float(value) for value in range(20)]
    case, sheet, out = (tmp_path / name for name in ("case.toml", "sheet.csv", "out.toml"))
    tables = "\n[[pair.pinion.tooth_flanks]]\ntooth = 3\nprofile_slope_um = 4.0\n"
    text = spur_case(f"pitch_deviation_um = {pitches}", torques=[100.0]).replace(
        "\n[pair.wheel]", f"{tables}[pair.wheel]"
    )
    case.write_text(text, encoding="utf-8")
    of = ("--gear", "pinion", "--loaded", "left")
    assert loa("measured", case, *of, "-o", sheet).exit_code == 0
    done = printed("measured", case, sheet, *of, "-o", out)
    assert sum(done["lines"].values()) == len(sheet.read_text().splitlines())
    assert [trace["slope_um"] for trace in done["traces"]] == pytest.approx([0.0, 4.0], abs=1e-6)
    first, second = (gear_pair(read_model(Case, file)).pinion for file in (case, out))
    assert second.pitch_deviation.cumulative == pytest.approx(first.pitch_deviation.cumulative, abs=1e-11)
    assert second.tooth_flanks[0].profile_slope == pytest.approx(4e-6, rel=1e-6)
    said = loa("measured", case, sheet, *of)
    assert "cumulative_pitch" in said.stdout and "cut-off" in said.stdout


def test_what_a_sheet_leaves_out_comes_first_and_decides_the_exit_code_if_asked(tmp_path):
    """Points of the loaded flank; those of the other one are of no use to the case."""
    case, sheet = tmp_path / "case.toml", tmp_path / "sheet.csv"
    case.write_text(spur_case(torques=[100.0]), encoding="utf-8")
    of = "--gear", "pinion", "--loaded", "right", "--strict"
    helix = [f"1,right,helix,,{z / 10},0.5" for z in range(-100, 101)]
    for extra, code in (("1,left,profile,5,,1", 0), ("1,right,helix,,900,0.5", EXIT_WARNINGS)):
        sheet.write_text("\n".join([HEAD, *helix, extra]) + "\n")
        done = loa("measured", case, sheet, *of)
        assert done.exit_code == code
        said = "warning (left_out): left out of the case: beyond the face width (points: 1)"
        assert done.stdout.startswith(said) == bool(code)


def test_the_verb_names_a_sheet_that_is_not_there(tmp_path):
    case = tmp_path / "case.toml"
    case.write_text(spur_case(torques=[100.0]), encoding="utf-8")
    done = loa("measured", case, tmp_path / "none.csv", "--gear", "pinion", "--loaded", "left", "--json")
    assert done.exit_code == 2
    assert "measured.file" in done.stderr or "measured.file" in json.dumps(done.stdout)
