"""Bands and sensitivities of a scene with a solid housing: guesses, flanks, and what is left out."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from housing_solid import housed_scene, write_block

from dynamics.acoustics import EquivalentRadiatedPower, sound_power_level
from dynamics.noise import (
    GUESSES,
    DesignFigure,
    SoundModel,
    forced_power,
    housing_radiation,
    sound_band,
    sound_sensitivities,
)
from dynamics.noise.sound_band import largest_level
from lineofaction.cli.scene_tables import tabled_scene
from lineofaction.gearbox.convert.housings import housings_in
from lineofaction.gearbox.convert.scene import TabledScene
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas import validated
from lineofaction.gearbox.schemas.noise_ranges import NoiseRanges
from lineofaction.gearbox.schemas.studied import RANGES
from lineofaction.gearbox.studies.computation import Means
from lineofaction.gearbox.studies.figures import figures_of
from lineofaction.gearbox.studies.noise import SensitivityFigures, SoundBandFigures
from lineofaction.gearbox.studies.noise.uncertainty import (
    GUESSED,
    MEASURED,
    SPECIFIED,
    _flank_scenes,
    _sensitivities_of,
    damping_of,
    spans_of,
)
from lineofaction.gearbox.subjects import scene_of

SPEED = np.linspace(100.0, 400.0, 12)
GEAR = {"teeth": 20, "face_width_mm": 25.0, "bore_diameter_mm": 40.0, "thickness_allowance_um": 90.0}
RELIEVED = GEAR | {"tip_relief_um": 10.0, "tip_relief_length_mm": 1.5}
CASE: dict[str, Any] = {
    "pair": {"normal_module_mm": 4.0, "center_distance_mm": 80.0, "pinion": RELIEVED, "wheel": GEAR},
    "load": {"torque_n_m": [50.0, 100.0]},
    "accuracy": {"level": "draft", "positions": 128, "model": "plane_strain", "receipt": "minimal"},
}


RELIEF = "meshes.mesh.case.pair.pinion.tip_relief_um"


def quiet(_stage: str, _fraction: float) -> None:
    """Report nothing."""


def made_from(folder: Path, **pair: Any) -> TabledScene:
    """Return the scene of a block with the case of its mesh written out."""
    write_block(folder / "block.step")
    scene: dict[str, Any] = housed_scene(folder)
    del scene["meshes"][0]["database_file"]
    scene["meshes"][0]["case"] = CASE | {"pair": CASE["pair"] | pair}
    file = folder / "scene.json"
    file.write_text(json.dumps(scene))
    return tabled_scene(*scene_of(file), None, quiet)


@pytest.fixture(scope="module")
def subject(tmp_path_factory):
    return made_from(tmp_path_factory.mktemp("scene"))


@pytest.fixture(scope="module")
def model(subject):
    (housing,) = subject.housings.values()
    radiation = housing_radiation(housing, EquivalentRadiatedPower(), (50.0, 10e3))
    return SoundModel(subject.scene, subject.housings, {"case": radiation})


def test_flanks_and_guesses_are_ranked_by_what_they_change(subject, model, tmp_path):
    rows, left_out = _sensitivities_of(subject, model, SPEED, 3, Means(tmp_path, quiet))
    names = [row.figure.name for row in rows]
    assert {"housing_damping", "bearing_stiffness", "mesh_damping", "housing_frequency"} <= set(names)
    assert "mount_stiffness" not in names
    pair = "meshes.mesh.case.pair"
    assert {f"{pair}.pinion.tip_relief_um", f"{pair}.wheel.profile_crowning_um"} <= set(names)
    assert f"{pair}.wheel.tip_relief_um" not in {*names, *left_out}
    assert "plane" in left_out[f"{pair}.wheel.helix_crowning_um"]
    sizes = [abs(row.change) for row in rows]
    assert sizes == sorted(sizes, reverse=True)
    (relief,) = (row for row in rows if row.figure.name == f"{pair}.pinion.tip_relief_um")
    assert (relief.figure.value, relief.figure.step) == (10.0, 2.0)
    assert abs(relief.change) > 0.01
    json.dumps([figures_of(SensitivityFigures, row) for row in rows], allow_nan=False)


@pytest.mark.law
def test_a_step_of_a_relief_changes_the_level_as_a_scene_with_that_relief_does(subject, model, tmp_path):
    """Between two tables solved from the start, and between those on the compliance of the first."""
    scenes = _flank_scenes(subject, RELIEF, tmp_path)
    other = made_from(tmp_path, pinion=RELIEVED | {"tip_relief_um": 40.0})
    levels = [
        largest_level(SPEED, forced_power(replace(model, scene=scene), SPEED, 3)[1])
        for scene in (
            subject.scene,
            other.scene,
            scenes.scene({RELIEF: 10.0}),
            scenes.scene({RELIEF: 40.0}),
        )
    ]
    assert abs(levels[1] - levels[0]) > 0.5
    assert levels[3] - levels[2] == pytest.approx(levels[1] - levels[0], abs=0.1)


@pytest.mark.law
def test_sensitivities_to_flanks_are_those_of_whole_responses(subject, model, tmp_path):
    scenes = _flank_scenes(subject, RELIEF, tmp_path)
    figure = DesignFigure(RELIEF, "um", 10.0, 15.0)
    rows, left_out = sound_sensitivities(
        model, SPEED, 3, [figure], lambda _: lambda value: scenes.scene({RELIEF: value}), quiet
    )
    (row,) = (row for row in rows if row.figure == figure)
    own, once, twice = (
        largest_level(SPEED, forced_power(replace(model, scene=scenes.scene({RELIEF: value})), SPEED, 3)[1])
        for value in (10.0, 25.0, 40.0)
    )
    assert not left_out and abs(once - own) > 0.1
    assert (row.change, row.change_of_two) == pytest.approx((once - own, twice - own), abs=1e-6)


def test_bands_go_to_json(subject, model):
    band = sound_band(model, SPEED, 2, spans_of(NoiseRanges(housing_damping=(0.4, 2.0))))
    known = {"damping_source": GUESSED.source, "damping_range": GUESSED.factors}
    told = json.loads(json.dumps(figures_of(SoundBandFigures, band, **known), allow_nan=False))
    assert len(told["total_low_db_a"]) == SPEED.size
    for level in (told["largest_total"], told["mean_total"], *(row["largest"] for row in told["orders"])):
        assert level["low_db_a"] <= level["level_db_a"] <= level["high_db_a"]
        assert set(level["above_db"]) >= {"housing_damping", "jointly", "mode_number"}
        assert "mount_stiffness" not in level["above_db"]


def test_an_order_that_varying_stiffness_alone_excites_has_the_widest_band(model):
    """The ranges were run with the mean stiffness, of which a table can lack an order."""
    band = sound_band(model, SPEED, 2, {}, cases=1)
    order, power = forced_power(model, SPEED, 3)
    about = band.about(order, power)
    assert about.order.tolist() == order.tolist() == [1.0, 2.0, 3.0]
    assert [level.width for level in about.largest] == pytest.approx(
        [*(level.width for level in band.largest), max(level.width for level in band.largest)]
    )
    levels = sound_power_level(power.weighted_power.max(axis=1))
    assert [level.nominal for level in about.largest] == pytest.approx(levels.tolist())
    assert about.total[0].nominal == pytest.approx(sound_power_level(power.total_weighted_power)[0])


def test_a_stated_and_a_measured_damping_narrow_its_range(subject):
    (housing,) = subject.inputs.housings
    known = {
        damping: damping_of(
            subject.inputs.model_copy(update={"housings": (housing.model_copy(update=stated),)}), ["case"]
        )
        for damping, stated in (
            ("usual", {"loss_factor": None}),
            ("loss", {"loss_factor": 0.02}),
            ("ratio", {"loss_factor": None, "damping_ratio": 0.008}),
            ("modes", {"loss_factor": None, "modal_damping": (0.006, 0.004)}),
        )
    }
    assert known == {"usual": GUESSED, "loss": SPECIFIED, "ratio": SPECIFIED, "modes": MEASURED}
    spans = [np.log(high / low) for low, high in (GUESSED.factors, SPECIFIED.factors, MEASURED.factors)]
    assert spans == sorted(spans, reverse=True)


def test_measured_ratios_of_modes_are_those_of_the_reduced_housing(tmp_path):
    write_block(tmp_path / "block.step")
    scene = housed_scene(tmp_path)
    scene["housings"][0].pop("loss_factor", None)
    scene["housings"][0] |= {"modal_damping": [0.006, 0.004]}
    file = tmp_path / "scene.json"
    file.write_text(json.dumps(scene))
    subject, folder = scene_of(file)
    (body,) = housings_in(subject, tmp_path / "cache", folder, quiet).values()
    assert body.damping_ratio[:3] == pytest.approx([0.006, 0.004, 0.004], rel=1e-6)
    scene["housings"][0] |= {"loss_factor": 0.01}
    file.write_text(json.dumps(scene))
    with pytest.raises(BadInput, match="left out with loss_factor"):
        scene_of(file)


def test_ranges_are_those_of_the_library_and_hold_what_the_scene_states():
    assert tuple(GUESSES) == RANGES
    for name, guess in GUESSES.items():
        stated = GUESSED.factors if name == "housing_damping" else getattr(NoiseRanges(), name)
        assert stated == (guess.usual.low, guess.usual.high)
    with pytest.raises(BadInput, match="the first at most 1") as caught:
        validated(NoiseRanges, {"mesh_damping": [1.1, 2.0]})
    assert caught.value.faults[0].field == "mesh_damping"
