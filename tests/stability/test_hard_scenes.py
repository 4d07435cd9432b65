"""Every hard scene passes, by laws of physics; `loa hardcases` runs the same."""

from __future__ import annotations

import os

import pytest

from service.hardcases import HARD_SCENES, HardScene

LONG = () if os.environ.get("LOA_LONG_SCENES") else ("ten_million_",)
"""Scenes of the nightly run alone, by how their names begin."""


@pytest.mark.parametrize("scene", HARD_SCENES, ids=lambda scene: scene.name)
def test_scene(scene: HardScene) -> None:
    if scene.name.startswith(LONG):
        pytest.skip("of the long run")
    outcome = scene.run()
    assert outcome.passed, f"{scene.criterion} But: {outcome.failure}"


def test_scenes_are_told_apart_and_explained() -> None:
    assert len({scene.name for scene in HARD_SCENES}) == len(HARD_SCENES)
    for scene in HARD_SCENES:
        assert scene.hard_because.endswith(".") and scene.criterion.endswith("."), scene.name
