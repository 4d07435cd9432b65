"""Every hard scene passes, by laws of physics; `loa hardcases` runs the same."""

from __future__ import annotations

import pytest

from service.hardcases import HARD_SCENES, HardScene

LONG = ("ten_million_", "job_past_deadline", "job_out_of_memory", "worker_killed_at_every_attempt")
"""How scenes begin that the nightly run has alone.

tests/unit/service/test_job_scheduler.py shows on a fake process what ends those jobs and how it is told, the
other scenes of jobs what one that ends badly leaves behind.
"""
SCENES = [
    pytest.param(scene, marks=[pytest.mark.nightly] * scene.name.startswith(LONG), id=scene.name)
    for scene in HARD_SCENES
]


@pytest.mark.parametrize("scene", SCENES)
def test_scene(scene: HardScene) -> None:
    outcome = scene.run()
    assert outcome.passed, f"{scene.criterion} But: {outcome.failure}"


def test_scenes_are_told_apart_and_explained() -> None:
    assert len({scene.name for scene in HARD_SCENES}) == len(HARD_SCENES)
    for scene in HARD_SCENES:
        assert scene.hard_because.endswith(".") and scene.criterion.endswith("."), scene.name
