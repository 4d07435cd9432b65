"""Hard scenes that the libraries must master: named, assessed by physics, run by users and by the tests.

A scene is a function in the file of its subject, declared by `Scenes.add`.
"""

from lineofaction.hardcases import broken_table, force_extraction
from lineofaction.hardcases.contact import (
    bodies,
    faces,
    flank_gaps,
    handover,
    load_range,
    sizes,
    tip_edges,
    tooth_numbers,
    touching_pair,
)
from lineofaction.hardcases.dynamics import (
    contact_loss,
    driven_gear,
    interrupted_run,
    resonance,
    stepping,
    supports,
    unlike_masses,
    unloaded_planet,
    varying_stiffness,
)
from lineofaction.hardcases.jobs import disturbances, process_deaths, shortages
from lineofaction.hardcases.scene import HardScene, Measured, Outcome
from lineofaction.hardcases.scene_process import run_scenes

__all__ = ["HARD_SCENES", "HardScene", "Measured", "Outcome", "run_scenes"]

HARD_SCENES: tuple[HardScene, ...] = tuple(
    scene
    for module in (
        load_range,
        touching_pair,
        tip_edges,
        flank_gaps,
        faces,
        handover,
        tooth_numbers,
        sizes,
        bodies,
        force_extraction,
        broken_table,
        contact_loss,
        resonance,
        stepping,
        driven_gear,
        varying_stiffness,
        supports,
        unlike_masses,
        unloaded_planet,
        interrupted_run,
        disturbances,
        process_deaths,
        shortages,
    )
    for scene in module.SCENES.listed
)
"""Hard scenes in the sequence in which `loa hardcases` and tests/stability run them."""
