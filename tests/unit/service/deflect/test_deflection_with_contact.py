"""A scene deflected with the contact of its gears over the face, on coarse meshes."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fe_contact.analysis import ste_database
from fe_contact.options import Run
from fe_contact.ste import SteDatabase
from service.convert.case import analysis_options, gear_pair, table_axes
from service.convert.scene import TabledScene, dynamic_scene
from service.schemas.scene import SceneInput
from service.studies.computation import Means
from service.studies.deflect import Inputs
from service.studies.deflect.mesh_contact import mesh_contact
from service.studies.deflect.result import GearboxDeflection
from service.studies.deflect.run import deflection_of

pytestmark = pytest.mark.usefixtures("coarse_sectors")

GEAR = {"teeth": 20, "face_width_mm": 12.0, "bore_diameter_mm": 20.0}
CASE = {
    "pair": {
        "normal_module_mm": 2.0,
        "helix_angle_deg": 15.0,
        "center_distance_mm": 40.0 / math.cos(math.radians(15.0)),
        "pinion": GEAR | {"helix_crowning_um": 4.0},
        "wheel": GEAR,
    },
    "load": {"torque_n_m": [20.0, 40.0]},
    "accuracy": {"level": "draft", "positions": 8, "receipt": "minimal"},
}
CASES = [
    {"name": "drive", "torque_n_m": 30.0},
    {"name": "coast", "torque_n_m": 20.0, "direction": "coast", "share": 0.5},
]


def scene_of(**case: Any) -> SceneInput:
    """The pair near the left ends of shafts on two bearings each."""
    apart = CASE["pair"]["center_distance_mm"]  # type: ignore[index]
    return SceneInput.model_validate_json(
        json.dumps(
            {
                "run": {"duration_s": 0.1},
                "shafts": [
                    {
                        "name": name,
                        "length_mm": 100.0,
                        "origin_mm": [x, 0.0, 0.0],
                        "sections": [{"length_mm": 100.0, "outer_diameter_mm": 16.0}],
                    }
                    for name, x in (("in", 0.0), ("out", apart))
                ],
                "gears": [
                    {"name": name, "shaft": shaft, "position_mm": 30.0, "bore_diameter_mm": 16.0}
                    for name, shaft in (("pinion", "in"), ("wheel", "out"))
                ],
                "bushings": [
                    {
                        "name": f"{shaft} {z:g}",
                        "shaft": shaft,
                        "position_mm": z,
                        "radial_stiffness_n_per_m": 1e8,
                        "axial_stiffness_n_per_m": 5e7,
                    }
                    for shaft in ("in", "out")
                    for z in (0.0, 100.0)
                ],
                "meshes": [{"name": "mesh", "driver": "pinion", "driven": "wheel", "case": CASE | case}],
                "drives": [{"name": "motor", "shaft": "in", "speed_rpm": [1500.0]}],
                "loads": [{"name": "brake", "shaft": "out", "torque_n_m": [25.0]}],
            }
        )
    )


def database(scene: SceneInput, folder: Path) -> SteDatabase:
    """The table of the case of its mesh."""
    (mesh,) = scene.meshes
    assert mesh.case is not None
    pair, axes, options = gear_pair(mesh.case), table_axes(mesh.case), analysis_options(mesh.case)
    return ste_database(pair, axes, options, Run(cache=folder / "compliance"))


@pytest.fixture(scope="module")
def tabled(tmp_path_factory: pytest.TempPathFactory) -> tuple[TabledScene, Path]:
    """The scene with its table, and where its gears are kept."""
    folder = tmp_path_factory.mktemp("contact")
    scene = scene_of()
    tables = {"mesh": database(scene, folder)}
    return TabledScene(scene, tables, dynamic_scene(scene, tables)), folder


@pytest.fixture(scope="module")
def result(tabled: tuple[TabledScene, Path]) -> GearboxDeflection:
    """Its deflection while driven and while coasting."""
    inputs = Inputs.model_validate_json(json.dumps({"load_cases": CASES, "positions": 16}))
    return deflection_of(tabled[0], inputs, Means(tabled[1], lambda *_: None))


def test_bodies_and_flanks_agree(result: GearboxDeflection) -> None:
    assert result.agreed and result.change <= 1e-6
    for flanks in result.flanks:
        # 16 positions of the bodies against 64 of the flanks, cubic between those of the table; face of 12 mm
        assert abs(flanks.centroid_difference) < 2.5e-6


def test_the_load_leans_to_the_end_at_which_the_gap_closes(result: GearboxDeflection) -> None:
    for case, flanks in zip(result.deflection.cases, result.flanks, strict=True):
        (mesh,) = case.meshes
        centroid = np.average(flanks.face_position, weights=flanks.face_load)
        assert abs(mesh.misalignment) > 1e-6
        assert math.copysign(1.0, centroid) == -math.copysign(1.0, mesh.misalignment)
        assert flanks.face_load_factor > 1.05
        assert math.copysign(1.0, mesh.face_centroid) == math.copysign(1.0, centroid)


def test_the_torque_on_the_pinion_is_that_of_the_case(result: GearboxDeflection) -> None:
    assert [flanks.torque for flanks in result.flanks] == pytest.approx([30.0, 20.0], rel=1e-6)
    assert all(flanks.face_load.mean() * 0.012 > 0.0 for flanks in result.flanks)
    for flanks in result.flanks:
        assert 0.0 < flanks.peak_to_peak < flanks.mean
        assert np.isfinite(flanks.peak_to_peak_error) and flanks.largest_pressure == pytest.approx(
            flanks.pattern.max(), rel=0.2
        )


def test_a_table_over_misalignments_is_that_of_an_analysis(tabled: tuple[TabledScene, Path]) -> None:
    scene, folder = tabled
    (mesh,) = scene.inputs.meshes
    assert mesh.case is not None
    contact = mesh_contact(mesh.case, scene.databases["mesh"], [20.0, 30.0], folder)
    table = contact.table([-3e-6, 0.0, 3e-6], [0.0, 1e-6])
    assert table.misalignment.tolist() == [-3e-6, 0.0, 3e-6] and contact.across_face
    mean = np.mean(table.face_centroid[..., 2], axis=(1, 2))  # type: ignore[attr-defined]
    assert mean[0] > mean[1] > mean[2]  # towards the end at which the gap closes
