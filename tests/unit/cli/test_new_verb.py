"""``loa new``: what is written can be run, keeps its rules, and says no to what does not exist."""

import math
import tomllib
from pathlib import Path

import numpy as np
import pytest
from command_line import loa

from fe_contact.geometry import specific_sliding
from fe_contact.ste import SteDatabase
from lineofaction.cli.new import KINDS, text_of_kind
from lineofaction.cli.options import PairWishes
from lineofaction.gearbox.convert.case import gear_pair
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas import Case, read_model, validated
from lineofaction.gearbox.schemas.scene import SceneInput

COARSE = ("--set", "accuracy.receipt=minimal", "--set", "accuracy.positions=8", "--level", "draft")
NARROW = ("--width", 8)  # few layers over the face
CASES = ("spur", "helical", "internal")


def written(kind: str, folder: Path, *options: object) -> Path:
    file = folder / f"{kind}.toml"
    done = loa("new", f"--{kind}", *options, "-o", file)
    assert done.exit_code == 0, done.output
    return file


def case(kind: str, **wanted: float) -> Case:
    return validated(Case, tomllib.loads(text_of_kind(kind, PairWishes(**wanted))))


@pytest.mark.parametrize("kind", CASES)
def test_a_case_is_analyzed_as_it_is_written(kind, tmp_path):
    file = written(kind, tmp_path, *NARROW)
    done = loa("analyze", file, "-o", tmp_path / "ste.nc", "--torque", 20, *COARSE)
    assert done.exit_code == 0, done.output
    assert "warning" not in done.stdout
    ste = SteDatabase.from_netcdf(tmp_path / "ste.nc").static_transmission_error
    assert np.all((ste > 0.1e-6) & (ste < 100e-6))


@pytest.mark.parametrize(("kind", "meshes"), [("scene", 1), ("planetary", 2)])
def test_a_scene_runs_as_it_is_written(kind, meshes, tmp_path):
    file = written(kind, tmp_path, *NARROW)
    scene = read_model(SceneInput, file)
    assert len(scene.meshes) == meshes
    coarse = ("receipt=minimal", "positions=8", "level=draft")
    settings = [part for text in coarse for part in ("--set", f"meshes.*.case.accuracy.{text}")]
    settings += ["--set", "meshes.*.case.load.torque_n_m=[10, 60]", "--set", "run.duration_s=0.002"]
    done = loa("simulate", file, "-o", tmp_path / "run.nc", *settings)
    assert done.exit_code == 0, done.output


def test_helical_figures_follow_the_rules():
    found = case("helical", module=1.8, teeth=23, ratio=67 / 23, helix=22.0)
    pair = gear_pair(found)
    assert (pair.pinion.teeth, pair.wheel.teeth) == (23, 67)
    assert pair.overlap_ratio == pytest.approx(1.5, abs=0.06)
    assert found.pair.center_distance_mm % 0.5 == 0.0
    ends = pair.path_of_contact.start, pair.path_of_contact.end
    at_start, at_end = (specific_sliding(pair, roll) for roll in ends)
    assert float(at_start[0]) == pytest.approx(float(at_end[1]), rel=2e-3)  # shifts have four digits
    plain = found.model_dump()
    for gear in ("pinion", "wheel"):
        plain["pair"][gear]["thickness_allowance_um"] = 0.0
    assert abs(gear_pair(validated(Case, plain)).transverse_base_backlash) < 1e-6
    assert pair.circumferential_backlash > 20e-6


@pytest.mark.parametrize("kind", [*CASES, "planetary", "scene"])
@pytest.mark.parametrize("module", [0.5, 2.0, 12.0])
@pytest.mark.parametrize("teeth", [18, 25, 41])
def test_pairs_exist_over_the_usual_sizes(kind, module, teeth):
    for ratio in (4.2, 5.2):
        for helix in (None, 15.0):
            text = text_of_kind(kind, PairWishes(module=module, teeth=teeth, ratio=ratio, helix=helix))
            assert text.startswith("# ")


def test_every_figure_that_was_given_is_in_the_file():
    found = case("spur", module=3.25, teeth=19, ratio=2.0, width=31.5).pair
    assert found.normal_module_mm == 3.25
    assert found.pinion.teeth == 19
    assert found.wheel.teeth in {37, 39}
    assert math.gcd(found.wheel.teeth, 19) == 1
    assert found.pinion.face_width_mm == found.wheel.face_width_mm == 31.5


def test_planets_fit_and_the_ratio_is_near():
    for ratio in (4.0, 5.0, 8.0):
        scene = validated(SceneInput, tomllib.loads(text_of_kind("planetary", PairWishes(ratio=ratio))))
        sun, ring = (mesh.case.pair for mesh in scene.meshes if mesh.case is not None)
        assert (sun.pinion.teeth + ring.wheel.teeth) % 3 == 0
        assert ring.wheel.teeth == sun.pinion.teeth + 2 * sun.wheel.teeth
        assert sun.center_distance_mm == pytest.approx(ring.center_distance_mm)
        assert 1.0 + ring.wheel.teeth / sun.pinion.teeth == pytest.approx(ratio, rel=0.05)


def test_what_cannot_be_is_refused(tmp_path):
    for arguments, words in (
        (("--spur", "--helical"), "one of --spur"),
        (("--planetary", "--ratio", 2.1), "at least 3.5 with 24 teeth"),
        (("-o", tmp_path / "pair.txt"), "a file ending in .toml"),
    ):
        done = loa("new", *arguments)
        assert done.exit_code == 2, arguments
        assert words in done.stderr
    with pytest.raises(BadInput):
        text_of_kind("internal", PairWishes(teeth=36, ratio=1.02))


def test_a_file_is_never_written_over(tmp_path):
    file = written("spur", tmp_path)
    before = file.read_bytes()
    done = loa("new", "--helical", "-o", file)
    assert done.exit_code == 2
    assert "a new file" in done.stderr
    assert file.read_bytes() == before


def test_without_a_file_the_text_is_printed():
    done = loa("new")
    assert done.stdout == text_of_kind("helical", PairWishes())
    assert set(KINDS) == {"spur", "helical", "internal", "planetary", "scene"}
