"""Every hard scene, one line each; `loa hardcases` and tests/stability run what stands here."""

from __future__ import annotations

from service.hardcases.contact import (
    bodies,
    edges,
    faces,
    gaps,
    handover,
    loads,
    ratios,
    sizes,
    tooth_counts,
)
from service.hardcases.dynamics import backlash, jumps, runs, steps, stiffness
from service.hardcases.scene import HardScene
from service.hardcases.tables import extraction, noise

HARD_SCENES: tuple[HardScene, ...] = (
    loads.SEVEN_DECADES,
    loads.ZERO_LOAD,
    handover.RELIEF_THAT_TOUCHES,
    edges.TIP_EDGE,
    edges.SHARP_TIPS,
    edges.ROUNDED_TIPS,
    gaps.GAP_BEYOND_DEFLECTION,
    gaps.PITCH_ERROR,
    gaps.NOISY_FLANKS,
    faces.FIVE_PER_CENT,
    faces.SINGLE_SLICE,
    faces.DUPLICATES,
    ratios.RATIO_1_01,
    ratios.RATIO_2,
    ratios.RATIO_2_6,
    tooth_counts.UNDERCUT,
    tooth_counts.TWENTY_TO_TWO_HUNDRED,
    sizes.MODULE_0_2,
    sizes.MODULE_40,
    sizes.HELIX_0_1,
    sizes.HELIX_40,
    sizes.FACES,
    bodies.SOFT_ON_STEEL,
    bodies.NEARLY_INCOMPRESSIBLE,
    bodies.THIN_RIM,
    extraction.SQUARE_WAVE,
    extraction.TWO_LOADS,
    extraction.LIFT_OFF,
    extraction.OUTSIDE,
    extraction.NEARLY_PARALLEL,
    noise.NOISE,
    backlash.NO_MEAN_LOAD,
    backlash.REVERSAL,
    backlash.IMPACTS,
    jumps.BOTH_SWEEPS,
    runs.REST_TO_REST,
    runs.CONTACT_LOST,
    steps.EXTREME_SPEEDS,
    steps.TORQUE_STEP,
    steps.TOLERANCES,
    steps.IMPLICIT_STEPS,
    steps.EXPLICIT_STEPS,
    stiffness.THREEFOLD,
)
