"""Populations of measured gears: a known one is read back, damaged files fall out one by one."""

import math
import random
from pathlib import Path

import numpy as np
import pytest
from command_line import loa, printed
from damaged_text import damaged
from fzg_reference import FOLDER, needs_fzg_reference
from machine_texts import GEAR, Wave, heading, machine_text, wave_texts
from spur_case import spur_case

from fe_contact import FlankModification, Gear, ToothFlank
from fe_contact.types import FloatArray
from lineofaction.gearbox.inspection.measured_gear import Chart
from lineofaction.gearbox.inspection.population import gear_files, inspected_gear, population, values_beside
from lineofaction.gearbox.problems import EXIT_WARNINGS, BadInput

LOADED = Chart(GEAR, "left", True)
MEAN = np.array([8.0, -3.0])
BETWEEN = np.array([[16.0, 6.0], [6.0, 9.0]])
WITHIN = np.array([[4.0, -1.0], [-1.0, 25.0]])
GEARS, TEETH = 100, (1, 6, 11, 16)
"""Slopes of profile and helix in um: their mean, covariance of gears, and of teeth about their gear."""


def value_text(slopes: FloatArray, number: int = 0) -> str:
    """Write slopes of profile and helix (n, 2) of left flanks as the machine prints them, in um.

    The evaluated profile is the usable one; heights rise where positions on the face fall.
    """
    lines = [line.replace("10:15", f"10:{number}") for line in heading(True, file="MW")]
    for row, (tooth, (profile, helix)) in enumerate(zip(TEETH, slopes, strict=True), 1):
        lines.append(f"2011{row} : fHa links {tooth} : {profile:.4f}")
        lines.append(f"1011{row} : fHb links {tooth} : {-helix:.4f}")
        lines.append(f"2071{row} : ffa links {tooth} : 2.0")
    lines += ["30110 : fp max links : 3.0", f"31010 : Fp links : {20.0 + number % 3}", "31610 : Fr : 14.0"]
    return "\n".join(lines) + "\n"


def batch(folder: Path, count: int = GEARS, seed: int = 2) -> None:
    draw = np.random.default_rng(seed)
    for number, gear in enumerate(draw.multivariate_normal(MEAN, BETWEEN, count)):
        teeth = gear + draw.multivariate_normal(np.zeros(2), WITHIN, len(TEETH))
        (folder / f"gear_{number:03d}.mew").write_text(value_text(teeth, number), encoding="utf-8")


@pytest.mark.law
def test_a_made_up_batch_is_read_back_within_its_sampling_error(tmp_path):
    batch(tmp_path)
    people = population([inspected_gear(path, LOADED) for path in gear_files(tmp_path)], "batch")
    of_slopes = [people.names.index(name) for name in ("profile_slope", "helix_slope")]
    pick = np.ix_(of_slopes, of_slopes)
    of_means = BETWEEN + WITHIN / len(TEETH)

    def errors(covariance, freedom):
        """Return standard errors of the entries of a sample covariance of normal deviates."""
        variance = np.diag(covariance)
        return np.sqrt((np.outer(variance, variance) + covariance**2) / freedom)

    mean = 1e6 * people.mean[of_slopes]
    assert (np.abs(mean - MEAN) < 2.5 * np.sqrt(np.diag(of_means) / GEARS)).all()
    of_teeth = errors(WITHIN, GEARS * (len(TEETH) - 1))
    assert (np.abs(1e12 * people.within[pick] - WITHIN) < 2.5 * of_teeth).all()
    of_gears = np.hypot(errors(of_means, GEARS - 1.0), of_teeth / len(TEETH))
    assert (np.abs(1e12 * people.between[pick] - BETWEEN) < 2.5 * of_gears).all()
    assert people.common[of_slopes] == pytest.approx([math.sqrt(16 / 20), math.sqrt(9 / 34)], abs=0.08)
    assert (people.teeth, len(people.gears)) == (GEARS * len(TEETH), GEARS)
    drawn = people.drawn(20_000, 1)[:, of_slopes]
    assert np.cov(drawn, rowvar=False) == pytest.approx(people.between[pick], abs=3e-13)


@pytest.mark.law
def test_stated_errors_of_small_batches_cover_what_they_say(tmp_path):
    """Of 40 batches of six gears two thirds lie within one standard error, nearly all within three."""
    true, off = np.sqrt(np.diag(BETWEEN)), []
    for seed in range(40):
        folder = tmp_path / str(seed)
        folder.mkdir()
        batch(folder, 6, seed)
        people = population([inspected_gear(path, LOADED) for path in gear_files(folder)], "batch")
        of_slopes = [people.names.index(name) for name in ("profile_slope", "helix_slope")]
        mean, error = 1e6 * people.mean[of_slopes], 1e6 * people.mean_error[of_slopes]
        spread = 1e6 * np.sqrt(np.diag(people.between))[of_slopes]
        off.append([(mean - MEAN) / error, (spread - true) / (1e6 * people.spread_error[of_slopes])])
    within = np.mean(np.abs(off) < 1.0, axis=(0, 2))
    assert ((within > 0.5) & (within < 0.85)).all()
    assert (np.mean(np.abs(off) < 3.0, axis=(0, 2)) > 0.9).all()


@pytest.mark.law
def test_principal_components_are_the_shapes_that_traces_differ_by(tmp_path):
    """Profiles of two shapes: a line of one variance and, orthogonal to it, a wave of another."""
    draw = np.random.default_rng(4)
    for number, (slope, height) in enumerate(draw.normal(0.0, (9.0, 6.0), (40, 2))):
        wave = Wave("profile", 3, "left", slope, abs(height))
        text, _ = wave_texts([wave, Wave("profile", 3, "right", slope, 1.0)], part=0.0)
        # the judge of the sign is a printed value, here of the left profile
        text += f"20111 : fHa links 3 : {slope:.3f}\n20121 : fHa rechts 3 : {slope:.3f}\n"
        (tmp_path / f"{number}.mka").write_text(text, encoding="utf-8")
    gears = [inspected_gear(path, LOADED) for path in gear_files(tmp_path)]
    traces = population(gears, "batch").traces["profile"]
    assert traces.number == 40
    # variance over even places: of a line slope^2 / 12, of a wave height^2 / 8
    rows = np.array([[gear.teeth[19]["profile_slope"], gear.teeth[19]["profile_range"]] for gear in gears])
    variances = 1e12 * np.var(rows, axis=0, ddof=1) / (12.0, 8.0)
    assert 1e12 * (traces.components[:2] ** 2).mean(axis=1) == pytest.approx(
        np.sort(variances)[::-1], rel=0.1
    )
    line = np.linspace(-1.0, 1.0, traces.mean.size)
    along = [abs(np.corrcoef(line, component)[0, 1]) for component in traces.components[:2]]
    assert max(along) > 0.99


def test_curves_and_values_of_a_gear_give_the_same_slopes(tmp_path):
    waves = [Wave(kind, 3, "left", slope, 2.0) for kind, slope in (("profile", 12.0), ("helix", 6.3))]
    curves, values = wave_texts(waves)
    for name, text in (("a.mka", curves), ("a.mew", values), ("b.mew", values), ("c.mka", curves)):
        # of c the curves alone are read, judged by the lines at their end
        extra = "20111 : fHa links 3 : 12.0\n" if name == "c.mka" else ""
        (tmp_path / name).write_text(text + extra, encoding="utf-8")
    assert [path.name for path in gear_files(tmp_path)] == ["a.mka", "b.mew", "c.mka"]
    first, second, third = (inspected_gear(path, LOADED) for path in gear_files(tmp_path))
    for slope in ("profile_slope", "helix_slope"):
        assert first.teeth[19][slope] == second.teeth[19][slope]
        assert third.teeth[19][slope] == pytest.approx(second.teeth[19][slope], abs=0.05e-6)


def test_a_form_is_the_height_of_a_parabola_over_the_evaluated_part(tmp_path):
    lines = ["tooth,flank,trace,roll_length_mm,face_position_mm,deviation_um"]
    for face in np.linspace(-10.0, 10.0, 401):
        lines.append(f"3,left,helix,,{face:.3f},{4.0 * (1.0 - (face / 10.0) ** 2):.6f}")
    (tmp_path / "a.csv").write_text("\n".join(lines), encoding="utf-8")
    assert inspected_gear(tmp_path / "a.csv", LOADED).teeth[3]["helix_form"] == pytest.approx(4e-6, rel=2e-3)
    (tmp_path / "b.mka").write_text(machine_text(LOADED, part=0.1), encoding="utf-8")
    forms = inspected_gear(tmp_path / "b.mka", LOADED).teeth
    assert max(abs(traits["helix_form"]) for traits in forms.values()) == pytest.approx(1.92e-6, rel=0.02)


def wrecked(text: str, seed: int) -> bytes:
    """Return a file with one kind of damage: of `damaged`, a wrong encoding, NUL, a huge count, a path."""
    draw = random.Random(seed)
    match seed % 5:
        case 0:
            return text.encode(draw.choice(["utf-16", "cp1252", "utf-32-be"]))
        case 1:
            at = draw.randrange(len(text))
            return (text[:at] + "\0" * draw.randrange(1, 2000) + text[at:]).encode()
        case 2:
            return text.replace("Zahn-Nr.: ", f"Zahn-Nr.: {10 ** draw.randrange(4, 40)}").encode()
        case 3:
            return text.replace("a gear", draw.choice(["../../etc/passwd", "C:\\a", "/dev/zero"])).encode()
        case _:
            return damaged(text, seed).encode("utf-8", "surrogatepass")


def test_a_hundred_damaged_files_of_a_folder_fall_out_one_by_one(tmp_path):
    case, folder = tmp_path / "case.toml", tmp_path / "gears"
    folder.mkdir()
    case.write_text(spur_case(torques=[100.0]), encoding="utf-8")
    batch(folder, 3)
    sound = [
        value_text(np.full((4, 2), 3.0)),
        machine_text(LOADED),
        *wave_texts([Wave("profile", 3, "left", 9.0, 2.0)]),
    ]
    for seed in range(100):
        ending = ("mew", "mka", "mka", "mew")[seed % 4]
        (folder / f"z{seed}.{ending}").write_bytes(wrecked(sound[seed % 4], seed))
    done = printed("measured", case, folder, "--gear", "pinion", "--loaded", "left")
    omitted = [warning["message"] for warning in done["warnings"]]
    assert len(done["gears"]) + len(omitted) == 103
    assert 10 <= len(omitted) <= 95
    assert all(len(text) < 400 and "left out of the population: z" in text for text in omitted)


def test_nothing_outside_of_the_folder_is_read(tmp_path):
    folder = tmp_path / "gears"
    folder.mkdir()
    batch(folder, 2)
    (tmp_path / "secret.mew").write_text(value_text(np.zeros((4, 2))), encoding="utf-8")
    (folder / "link.mew").symlink_to(tmp_path / "secret.mew")
    assert [path.name for path in gear_files(folder)] == ["gear_000.mew", "gear_001.mew"]
    (folder / "curves.mka").write_text("", encoding="utf-8")
    assert values_beside(folder / "curves.mka") is None
    (folder / "curves.mew").symlink_to(tmp_path / "secret.mew")
    assert values_beside(folder / "curves.mka") is None
    (folder / "gear_000.mka").write_text("", encoding="utf-8")
    assert values_beside(folder / "gear_000.mka") is not None


def test_the_verb_prints_the_population_and_says_what_it_leaves_out(tmp_path):
    case, folder, out = tmp_path / "case.toml", tmp_path / "gears", tmp_path / "out.json"
    folder.mkdir()
    case.write_text(spur_case(torques=[100.0]), encoding="utf-8")
    batch(folder)
    of = ("--gear", "pinion", "--loaded", "left", "--strict")
    done = loa("measured", case, folder, *of, "-o", out)
    assert done.exit_code == 0
    assert "100 gears, 400 teeth" in done.stdout
    assert "For loa scatter: --population 'pinion.helix_slope_um=" in done.stdout
    assert out.is_file()
    names = [row.partition("=")[0] for row in printed("measured", case, folder, *of)["population"]]
    assert names == [
        "pinion.helix_slope_um",
        "pinion.profile_slope_um",
        "pinion.helix_slope_um*pinion.profile_slope_um",
    ]
    (folder / "other.mew").write_text(
        value_text(np.zeros((4, 2))).replace("z.........: 20", "z.........: 21")
    )
    done = loa("measured", case, folder, *of)
    assert done.exit_code == EXIT_WARNINGS
    said = (
        "warning (left_out): left out of the population: other.mew: the file of a gear of 20 teeth; it has 21"
    )
    assert done.stdout.startswith(said)
    with pytest.raises(BadInput, match="two gears or more"):
        population([inspected_gear(gear_files(folder)[0], LOADED)], "gears")


def test_the_rows_for_a_study_remove_what_measured_flanks_lack(tmp_path):
    """Figures of a case remove where deviations of a tooth are in excess: both surfaces cancel."""
    case, folder = tmp_path / "case.toml", tmp_path / "gears"
    folder.mkdir()
    case.write_text(spur_case(torques=[100.0]), encoding="utf-8")
    rolls = np.linspace(*sorted((GEAR.form_roll_length, GEAR.tip_roll_length)), 201)
    flank = ToothFlank(1, profile_slope=9e-6, profile_form=2e-6, helix_slope=-5e-6, helix_form=3e-6)
    head = "tooth,flank,trace,roll_length_mm,face_position_mm,deviation_um"
    rows = [head]
    for roll, value in zip(rolls, flank.excess(GEAR, rolls, np.zeros(201)), strict=True):
        rows.append(f"1,left,profile,{1e3 * roll:.6f},,{1e6 * value:.6f}")
    faces = np.linspace(-12.5e-3, 12.5e-3, 201)
    for face, value in zip(faces, flank.excess(GEAR, np.full(201, rolls.mean()), faces), strict=True):
        rows.append(f"1,left,helix,,{1e3 * face:.6f},{1e6 * value:.6f}")
    for name in ("a.csv", "b.csv"):
        (folder / name).write_text("\n".join(rows), encoding="utf-8")
    done = printed("measured", case, folder, "--gear", "pinion", "--loaded", "left")
    stated = dict(row.split("=") for row in done["population"] if "*" not in row)
    figures = {
        name.removeprefix("pinion.").removesuffix("_um"): 1e-6 * float(text.split("/")[0])
        for name, text in stated.items()
    }
    modified = FlankModification(**figures)
    place = np.meshgrid(rolls, faces, indexing="ij")
    both = modified.removed(GEAR, *place) + flank.excess(GEAR, *place)
    assert np.abs(both - both.mean()).max() < 0.15e-6


@needs_fzg_reference
@pytest.mark.parametrize(
    ("pattern", "gear"),
    [
        ("wheel*.mew", Gear(52, 1e-3, 15e-3, 20e-3, profile_shift_coefficient=0.011, tip_diameter=54.022e-3)),
        (
            "pinion*.mew",
            Gear(51, 1e-3, 17e-3, 20e-3, profile_shift_coefficient=-0.2033, tip_diameter=52.894e-3),
        ),
    ],
    ids=["wheels", "pinions"],
)
@pytest.mark.parametrize("loaded", ["left", "right"])
def test_measured_gears_lie_among_those_drawn_from_them(pattern, gear, loaded):
    chart = Chart(gear, "left" if loaded == "left" else "right", True)
    gears = [inspected_gear(path, chart) for path in sorted(FOLDER.glob(pattern))]
    people = population(gears, pattern)
    drawn = people.drawn(300, 1, people.teeth / len(gears))
    low, high = np.quantile(drawn, (0.05, 0.95), axis=0)
    assert ((people.of_gears >= low) & (people.of_gears <= high)).all()
