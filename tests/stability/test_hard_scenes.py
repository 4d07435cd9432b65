"""Every hard scene passes, by laws of physics; `loa hardcases` runs the same."""

import pytest

from lineofaction.hardcases import HARD_SCENES

LONG = (
    "ten_million_", "job_", "worker_killed_at_every_attempt", "mesher_without_end",
    "teeth_20_to_200", "thin_rim",
)  # fmt: skip
"""How scenes begin that the nightly run has alone: seven CPU seconds and more each.

Of the jobs that end badly the suite keeps `worker_killed_once`, whose result must be that of Python; what the
others end by and say is shown in tests/unit/service/test_job_scheduler.py and
tests/unit/fe_contact/mesh/test_gmsh_child.py. Teeth like those of the last two have sound tables in
test_odd_but_feasible.py.
"""
SCENES = [
    pytest.param(scene, marks=[pytest.mark.nightly] * scene.name.startswith(LONG), id=scene.name)
    for scene in HARD_SCENES
]


@pytest.mark.drawn
@pytest.mark.law
@pytest.mark.parametrize("scene", SCENES)
def test_scene(scene):
    outcome = scene.run()
    assert outcome.passed, f"{scene.criterion} But: {outcome.failure}"


def test_scenes_are_told_apart_and_explained():
    assert len({scene.name for scene in HARD_SCENES}) == len(HARD_SCENES)
    for scene in HARD_SCENES:
        assert scene.hard_because.endswith(".") and scene.criterion.endswith("."), scene.name
