"""Hard scenes that the libraries must master: named, assessed by physics, run by users and by the tests.

A scene is a function in the file of its subject, declared by `Scenes.add`.
"""

from lineofaction.hardcases import tables
from lineofaction.hardcases.contact import flanks, pairs, sizes
from lineofaction.hardcases.dynamics import contact_loss, stepping
from lineofaction.hardcases.jobs import disturbances
from lineofaction.hardcases.scene import HardScene, Measured, Outcome, run_scenes

__all__ = ["HARD_SCENES", "HardScene", "Measured", "Outcome", "run_scenes"]

HARD_SCENES: tuple[HardScene, ...] = tuple(
    scene
    for scenes in (
        flanks.SCENES,
        pairs.SCENES,
        sizes.SCENES,
        tables.SCENES,
        contact_loss.GAPS,
        stepping.STEPS,
        contact_loss.STIFFNESSES,
        stepping.TRAINS,
        disturbances.SCENES,
    )
    for scene in scenes.listed
)
"""In the order in which `loa hardcases` and tests/stability run them."""
