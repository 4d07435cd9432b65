"""What the verbs of studies of cases find, beyond the contract of all studies: effects, roots, tolerances."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command_line import loa, printed
from geared_scenes import gear_pair_scene
from spur_case import spur_case

from bounds.error_digits import with_error
from dynamics.ablation import ablate
from lineofaction.gearbox.studies.ablate.run import RUN
from lineofaction.gearbox.studies.root_stress.run import RUN as ROOT_STRESS
from lineofaction.report.drawing.image import png
from lineofaction.report.effects.ablate import PAGE
from lineofaction.report.flank import root_stress

RELIEF = "tip_relief_um = 15.0\ntip_relief_length_mm = 1.2"
RELIEVED = spur_case(RELIEF, RELIEF, [20.0, 100.0], positions=64)
PLAIN = spur_case(torques=[50, 100])


def told(folder: Path, case: str, verb: str, *arguments: object) -> Any:
    file = folder / "case.toml"
    file.write_text(case, encoding="utf-8")
    return printed(verb, file, *arguments)


# ``loa ablate``.


def test_effects_of_a_case_change_what_the_documentation_says(tmp_path):
    only = "tooth_coupling,profile_modification,misalignment"
    found = told(tmp_path, RELIEVED, "ablate", "--only", only)
    assert found["of"] == "case"
    assert found["left_out"] == {"misalignment": "the gears are aligned"}
    assert found["torque_n_m"] == pytest.approx([20.0, 100.0])
    coupling, relief = found["effects"]
    assert (coupling["name"], relief["name"]) == ("tooth_coupling", "profile_modification")
    # docs/effects.md#profile_modification: what ignoring the relief changes at 100 N m
    assert relief["relative_mean_change"][1] == pytest.approx(-0.138, abs=0.02)
    for entry in (coupling, relief):
        whole = entry["with"]["mean_um"][1]
        assert 1.0 < whole < 20.0
        assert entry["mean_change_um"][1] == pytest.approx(entry["without"]["mean_um"][1] - whole, rel=1e-9)
        assert 0.5 < entry["estimate"]["mean_um"] / entry["mean_change_um"][1] < 2.0
    text = loa("ablate", tmp_path / "case.toml", "--only", only)
    assert "not toggled: misalignment: the gears are aligned" in text.stdout


def test_a_scene_is_drawn_with_and_without_an_effect():
    made = ablate(gear_pair_scene(duration=0.03), only=["lateral", "friction"])
    found = RUN.figures(made)
    (lateral,) = found["effects"]
    assert np.shape(lateral["order_change_um"]) == (1, 5)
    assert np.shape(lateral["bearing_order_change_n"]) == (4, 5)
    figure = PAGE.figure(made)
    assert [panel.title for panel in figure.content] == ["Transmission error", "Bearing force"]
    assert [line.name for line in figure.content[0].lines] == ["as decided", "without lateral"]
    assert png(figure).startswith(b"\x89PNG")
    ((name, state, *_),) = next(PAGE.text(made)).rows
    assert (name, state) == ("lateral", "on")


# ``loa root-stress``.


def test_roots_are_stressed_by_the_load_and_drawn_with_their_peaks(tmp_path):
    file, picture = tmp_path / "root.nc", tmp_path / "root.png"
    found = told(tmp_path, PLAIN, "root-stress", "-o", file)
    assert found["torque_n_m"] == pytest.approx(100.0)  # the highest load of the case
    half = told(tmp_path, PLAIN, "root-stress", "--torque", "50", "--image", picture)
    assert picture.read_bytes().startswith(b"\x89PNG")
    shown = loa("root-stress", tmp_path / "case.toml").stdout
    figure = root_stress.PAGE.figure(ROOT_STRESS.file.read(file))
    for gear, panel in zip(("pinion", "wheel"), figure.content, strict=True):
        tension = found[gear]["tension"]
        assert tension["stress_mpa"] == pytest.approx(73.0, rel=0.03)  # 25 MPa of F_t/(b m) by 1.71 by 1.78
        assert half[gear]["tension"]["stress_mpa"] == pytest.approx(0.5 * tension["stress_mpa"], rel=0.02)
        assert found[gear]["compression"]["stress_mpa"] < 0.0
        assert 0.0 < tension["error_mpa"] < 0.04 * tension["stress_mpa"]  # roots, positions and contact
        assert 30.0 < tension["tangent_angle_deg"] < 40.0
        assert max(panel.lines[0].y) == pytest.approx(tension["stress_mpa"], rel=1e-9)
        assert min(panel.lines[2].y) == pytest.approx(found[gear]["compression"]["stress_mpa"], rel=1e-9)
        assert panel.references[0].value == tension["position"]
        (row,) = [line for line in shown.splitlines() if line.split()[:2] == [gear, "tension"]]
        assert with_error(tension["stress_mpa"], tension["error_mpa"]) in row


# ``loa scatter``.


def test_pairs_are_drawn_within_the_tolerances_of_their_class(tmp_path):
    plane = PLAIN.replace('"draft"', '"draft"\nmodel = "plane_strain"')
    page = tmp_path / "scatter.html"
    found = told(tmp_path, plane, "scatter", "--samples", "24", "--class", "8", "-o", page)
    assert "rank correlation" in page.read_text(encoding="utf-8")
    parts = ("profile_form_um", "profile_slope_um")
    assert found["names"] == [f"{gear}.{part}" for gear in ("pinion", "wheel") for part in parts]
    assert len(found["peak_to_peak_um"]) == 24
    # class 8: (0.4 m_n + 0.001 d + 4) sqrt(2)^3 = 16.07 um, of which whole ones count
    assert found["asked"]["tolerances"]["pinion.profile_slope_um"] == pytest.approx(16.0, rel=1e-12)
    assert max(max(row) for row in found["deviation_um"]) <= 16.0
