"""Files of measuring machines judge how they are read: by printed values, or by their tips."""

import tomllib
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from command_line import loa, printed
from damaged_text import fates_of_a_hundred
from fzg_reference import FOLDER, needs_fzg_reference
from machine_texts import GEAR, Wave, heading, wave_texts
from spur_case import spur_case

from fe_contact.geometry import Gear
from lineofaction.gearbox.inspection.machine_file import MachineFile, machine_file, machine_sheet
from lineofaction.gearbox.inspection.machine_judgement import judgement_of
from lineofaction.gearbox.inspection.machine_values import value_file
from lineofaction.gearbox.inspection.reading import read_sheet
from lineofaction.gearbox.problems import EXIT_WARNINGS, BadInput
from service.reading.sheets import case_as_made

WAVES = (
    Wave("profile", 3, "left", 12.0, 4.0),
    Wave("profile", 3, "right", -7.0, 3.0),
    Wave("helix", 5, "left", 9.0, 2.0),
    Wave("helix", 5, "right", 5.4, 6.0),
)
CURVES, VALUES = wave_texts(WAVES)


@pytest.mark.law
def test_printed_slopes_and_forms_are_recomputed_with_their_signs():
    """A straight line and a wave of whole periods: slope and form in closed form."""
    sheet = read_sheet(CURVES, GEAR, "gear.mka", VALUES)
    assert (sheet.recomputed, sheet.differences) == (2 * len(WAVES), ())


@pytest.mark.parametrize("line", range(2 * len(WAVES)))
def test_a_printed_value_that_differs_is_named(line):
    lines = VALUES.splitlines()
    row = len(lines) - 2 * len(WAVES) + line
    label, _, value = lines[row].rpartition(":")
    lines[row] = f"{label}: {float(value) + 0.3:.1f}"
    sheet = read_sheet(CURVES, GEAR, "gear.mka", "\n".join(lines))
    (difference,) = sheet.differences
    wave = WAVES[line // 2]
    assert (
        f"of tooth {wave.number} {wave.flank}: {float(value) + 0.3:.1f} µm printed, {float(value):.1f} µm"
        in difference
    )


def test_values_of_another_gear_are_refused():
    with pytest.raises(BadInput, match="of the same gear"):
        read_sheet(CURVES, GEAR, "gear.mka", VALUES.replace("10:15", "10:16"))


def tips(left: float, right: float) -> str:
    """Return curves of a left and a right profile whose last places stand off by so many um of material."""
    text, _ = wave_texts(WAVES[:2])
    lines = text.splitlines()
    ends = [row for row, line in enumerate(lines) if line.startswith("Profil:")]
    for row, sign, excess in ((ends[1] - 1, -1.0, left), (len(lines) - 1, 1.0, right)):
        before = float(lines[row - 1].split()[-1])
        lines[row] = " ".join([f"{before + sign * excess:.6f}"] * len(lines[row].split()))
    return "\n".join(lines) + "\n"


def test_without_printed_values_both_tips_must_fall_off():
    sheet = read_sheet(tips(-40.0, -40.0), GEAR, "gear.mka")
    assert (sheet.recomputed, sheet.differences) == (0, ())
    for left, right, flank in ((40.0, -40.0, "left"), (-40.0, 40.0, "right"), (40.0, 40.0, "left")):
        with pytest.raises(BadInput, match=f"tips fall off on both flanks; those of {flank} profiles rise"):
            read_sheet(tips(left, right), GEAR, "gear.mka")
    flat = wave_texts([Wave("profile", 3, "left", 12.0, 0.2)])[0]
    (doubt,) = read_sheet(flat, GEAR, "gear.mka").differences
    assert doubt.startswith("the sign of left profiles")


def test_single_pitches_that_are_no_steps_of_the_cumulative_ones_are_named():
    rows = [f"{k} {1.0 if k % 2 else -1.0} {1.0 if k % 2 else 0.0} .1" for k in range(1, 21)]
    rows[6] = "7 1.5 1.0 .1"
    text = "\n".join((CURVES + "linke Zahnflanke", *rows))
    (difference,) = read_sheet(text, GEAR, "gear.mka", VALUES).differences
    assert difference.startswith("f_p of tooth 7 left: 1.5 µm printed, 1.0 µm by F_p")


def test_the_verb_judges_by_the_file_beside_and_stops_if_asked(tmp_path):
    case, curves, out = (tmp_path / name for name in ("case.toml", "gear.mka", "out.toml"))
    case.write_text(spur_case(torques=[100.0]), encoding="utf-8")
    curves.write_text(CURVES, encoding="utf-8")
    of = ("--gear", "pinion", "--loaded", "left", "-o", out, "--strict")
    (tmp_path / "gear.mew").write_text(VALUES, encoding="utf-8")
    done = loa("measured", case, curves, *of)
    assert (done.exit_code, out.exists()) == (0, True)
    assert done.stdout.startswith("Values printed by the machine: 8 of 8 recomputed within 0.1 µm.")
    out.unlink()
    (tmp_path / "gear.mew").write_text(VALUES.replace("12.0", "12.4"), encoding="utf-8")
    done = loa("measured", case, curves, *of)
    assert (done.exit_code, out.exists()) == (EXIT_WARNINGS, False)
    warning = "warning (machine_value): f_Halpha of tooth 3 left: 12.4 µm printed, 12.0 µm recomputed"
    assert done.stdout.startswith(warning)
    assert "7 of 8 recomputed" in done.stdout


def test_a_service_says_first_what_differs():
    """Its text has the printed results behind the curves."""
    case = tomllib.loads(spur_case(torques=[100.0]))
    text = CURVES + "20111 : fHa links 3 : 12.4\n20121 : fHa rechts 3 : -7.0\n"
    sheet = {"csv": text, "gear": "pinion", "loaded": "left", "cutoff_mm": None}
    answer = case_as_made({"inputs": {"case": case}, "measured": sheet}, Path(), lambda *_: None)
    assert answer["left_out"] == ["f_Halpha of tooth 3 left: 12.4 µm printed, 12.0 µm recomputed"]


@pytest.mark.law
def test_waves_of_a_pitch_table_are_ghost_orders_of_the_gear(tmp_path):
    """Three waves of pitches in a turn, over 6.7 teeth each: the load shares less than a tenth of them."""
    case, curves, made, table = (tmp_path / name for name in ("case.toml", "a.mka", "made.toml", "ste.nc"))
    case.write_text(spur_case(torques=[300.0], model="plane_strain"), encoding="utf-8")
    places = 4.0 * np.cos(2.0 * np.pi * 3.0 * np.arange(1, 21) / 20.0)
    rows = zip(places - np.roll(places, 1), places - places[-1], strict=True)
    lines = [
        *heading(True),
        "rechte Zahnflanke",
        *(f"{k} {f:.4f} {p:.4f} .1" for k, (f, p) in enumerate(rows, 1)),
    ]
    curves.write_text("\n".join(lines), encoding="utf-8")
    printed("measured", case, curves, "--gear", "pinion", "--loaded", "right", "-o", made)
    printed("analyze", made, "-o", table)
    curve = printed("ste", table)
    amplitude = dict(zip(curve["order_name"], curve["amplitude_um"], strict=True))
    full = 4.0 * np.cos(np.radians(20.0))
    assert 0.9 * full < amplitude["pinion 3"] < full
    others = [amplitude[f"pinion {turns}"] for turns in (1, 2, 4, 5)]
    assert max(others) < 0.02 * full


def taken_with(curves: bool) -> Callable[[str], object]:
    if curves:
        return lambda text: read_sheet(text, GEAR, "gear.mka", VALUES)
    return lambda text: read_sheet(CURVES, GEAR, "gear.mka", text)


@pytest.mark.parametrize("curves", [True, False], ids=["curves", "values"])
def test_a_hundred_damaged_files_of_a_pair_are_refused_or_judged(curves, monkeypatch):
    fates = fates_of_a_hundred(CURVES if curves else VALUES, taken_with(curves), monkeypatch)
    assert min(fates["taken"], fates["refused"]) >= 5, fates


WHEEL = Gear(52, 1e-3, 15e-3, 20e-3, profile_shift_coefficient=0.011, tip_diameter=54.022e-3)
PINION = Gear(51, 1e-3, 17e-3, 20e-3, profile_shift_coefficient=-0.2033, tip_diameter=52.894e-3)
FILES = (
    ("wheel_97340-neu_trimmed.mka", "wheel_97340-neu.mew", WHEEL, 23),
    ("pinion_95911-neu_part.mka", "pinion_95911-neu.mew", PINION, 35),
)


def reference(name: str) -> str:
    return (FOLDER / name).read_text(encoding="utf-8")


@needs_fzg_reference
@pytest.mark.law
@pytest.mark.parametrize(("curves", "values", "gear", "number"), FILES, ids=["wheel", "pinion"])
def test_all_results_of_measured_gears_are_recomputed(curves, values, gear, number):
    file = machine_file(reference(curves), gear)
    judgement = judgement_of(file, gear, value_file(reference(values)).printed)
    assert (judgement.recomputed, judgement.differences) == (number, ())
    assert (
        judgement_of(file, gear).differences == ()
    )  # both tips fall off: without printed values it is the same


def touched(text: str, side: str, teeth: int) -> list[float]:
    """Return how far the flanks of a side stand clockwise of their design in um, by *Teilung*: X - PHI y."""
    rows = [line.split() for line in text[text.index("Z-Nr. Seite") :].splitlines()[1:] if line.strip()]
    places = {}
    for number, of_side, phi, x, y, _ in rows:
        # the left flank of tooth 1 is the last that is touched, after a whole turn
        turned = 360.0 * (teeth if (number, of_side) == ("1", "L") else int(number) - 1) / teeth
        if of_side == side:
            places[int(number)] = 1e3 * (float(x) - np.radians(float(phi) + turned) * float(y))
    return [places[number] for number in sorted(places)]


@needs_fzg_reference
@pytest.mark.law
@pytest.mark.parametrize(
    ("curves", "gear"), [(FILES[0][0], WHEEL), (FILES[1][0], PINION)], ids=["wheel", "pinion"]
)
def test_teeth_stand_where_the_probe_touched_them(curves, gear):
    """*Teilung* runs clockwise; a tooth ahead of its place clockwise has a larger pitch of the sheet."""
    text = reference(curves)
    sheet = machine_sheet(machine_file(text, gear), gear)
    for side, flank in (("L", "left"), ("R", "right")):
        pitches = {
            p.tooth: 1e6 * p.deviation
            for p in sheet.points
            if (p.trace, p.flank) == ("cumulative_pitch", flank)
        }
        places = np.array(touched(text, side, gear.teeth))
        read = np.array([pitches[tooth] for tooth in range(1, gear.teeth + 1)])
        errors = [
            np.std(places - np.roll(read[::step], shift)) for step in (1, -1) for shift in range(gear.teeth)
        ]
        assert errors[0] < 0.2
        assert min(errors[1:]) > 0.3


@needs_fzg_reference
def test_traces_are_numbered_like_the_tables_of_pitches():
    """The pinion runs out by 11.8 um: its slopes of profiles follow, largest on the side that stands out.

    A flank whose tooth stands at an angle from that side has the slope of the eccentricity times the roll
    angle, at a pressure angle of about 21 degrees. Counted the other way the slopes contradict it.
    """
    file = machine_file(reference(FILES[1][0]), PINION)
    printed = value_file(reference(FILES[1][1])).printed
    residuals = {}
    for direction in (1, -1):
        misses = []
        for flank, lean in (("left", 1.0), ("right", -1.0)):
            angles, eccentricity, outward = run_out(file)
            slopes = {p.tooth: p.value for p in printed if (p.figure, p.flank) == ("fHa", flank)}
            teeth = np.array(sorted(slopes))
            # the tooth that the other direction would mean, by the same angles of the table
            rows = teeth - 1 if direction > 0 else (1 - teeth) % PINION.teeth
            roll = 2.2196e-3 / PINION.base_radius
            expected = eccentricity * roll * np.cos(angles[rows] - outward - lean * np.radians(21.0))
            measured = np.array([slopes[tooth] for tooth in teeth])
            misses += list((measured - measured.mean()) - (expected - expected.mean()))
        residuals[direction] = float(np.sqrt(np.mean(np.square(misses))))
    assert residuals[1] < 0.2
    assert residuals[-1] > 3.0 * residuals[1]


def run_out(file: MachineFile) -> tuple[np.ndarray, float, float]:
    """Return angles of the rows, eccentricity in um and the angle where the gear stands out, by F_r."""
    table = file.tables[0].values[:, 2]
    angles = 2.0 * np.pi * np.arange(1, table.size + 1) / table.size
    wave = 2.0 * np.mean(table * np.exp(1j * angles))
    return angles, float(abs(wave)), float(np.angle(wave))
