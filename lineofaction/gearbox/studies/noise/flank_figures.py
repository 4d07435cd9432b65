"""Tip relief and crowning of the meshes of a scene, as figures of its design."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from dynamics.noise import DesignFigure
from lineofaction.gearbox.convert.scene import TabledScene
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.studies.study.paths import places_of
from lineofaction.gearbox.studies.study.scenes import VariedScene

GEARS = ("pinion", "wheel")
AMOUNTS = ("tip_relief_um", "profile_crowning_um", "helix_crowning_um")
STEP = 2.0
"""um; a tolerance of class 5 is about as much."""


def flank_figures(scene: SceneInput) -> Iterator[DesignFigure]:
    """Yield the figures of all meshes with a case; tip relief only where it has a length."""
    for mesh in scene.meshes:
        for gear in GEARS if mesh.case is not None else ():
            assert mesh.case is not None
            flank = getattr(mesh.case.pair, gear)
            for amount in AMOUNTS:
                if amount != "tip_relief_um" or flank.tip_relief_length_mm > 0.0:
                    path = f"meshes.{mesh.name}.case.pair.{gear}.{amount}"
                    yield DesignFigure(path, "um", float(getattr(flank, amount)), STEP)


def flank_scenes(subject: TabledScene, path: str, home: Path) -> VariedScene:
    """Return the scene by a figure of its flanks: its table is solved again on the same compliance."""
    places = {path: places_of(subject.inputs, "sensitivities", path)}
    return VariedScene(subject.inputs.model_dump_json(), subject.databases, places, str(home))
