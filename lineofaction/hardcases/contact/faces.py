"""Hard pairs by their faces: misaligned, or a single slice wide."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fe_contact.contact import ContactProblem, ContactSolution
from fe_contact.contact.slices import POINTS
from fe_contact.types import FloatArray
from lineofaction.hardcases.contact.contact_case import (
    NOMINAL_TORQUE,
    ContactCase,
    contact_case,
    even_positions,
    max_relative,
    nominal_pair,
)
from lineofaction.hardcases.contact.laws import soundness
from lineofaction.hardcases.scene import Measured, Scenes, largest

SCENES = Scenes("contact")

_MISALIGNMENT = 300e-6
_WIDE = 60e-3


@SCENES.add(
    "misaligned_to_5_percent",
    "0.3 mm of misalignment over the face: one slice of nineteen carries, and gaps are 40 times the "
    "deflection.",
    "The side that comes closer carries; both sides are mirror images, in STE and in the place of the load; "
    "the rigid gap of plain flanks is that of the wedge, and tip edges only touch sooner.",
)
def _five_per_cent() -> Sequence[Measured]:
    """Misalign a wide pair until one slice of nineteen carries all, to either side."""
    case, mirrored_case = (
        contact_case(
            nominal_pair(face_width=_WIDE),
            [0.02 * NOMINAL_TORQUE],
            model="3d",
            misalignment=sign * _MISALIGNMENT,
        )
        for sign in (1.0, -1.0)
    )
    position = even_positions(24)
    problem, solution = case.solve(position)
    mirrored_problem, mirrored = mirrored_case.solve(position)
    slices = case.plan.discretization.slices
    wedge = 0.5 * _MISALIGNMENT * (1.0 - 1.0 / (slices * POINTS))  # at the outermost point of a slice
    candidates = problem.candidates
    face = candidates.face_position
    plain = np.where(candidates.touch.lag == 1.0, candidates.gap, np.inf).min(axis=1)
    loaded = [np.unique(face[force > 0.0]).size for force in solution.force[:, 0]]
    return (
        *soundness(problem, solution, 8),
        Measured(
            "part of the face that carries, %", 100.0 * (max(loaded) / np.unique(face).size), maximum=6.0
        ),
        Measured(
            "centroid over half the face width, to the side that comes closer, least",
            # positive misalignment opens the gap towards larger face positions: the load is at the lower ones
            -_centroid(problem, solution).max() / (0.5 * _WIDE),
            minimum=0.9,
        ),
        Measured(
            "misaligned to the other side: relative difference of STE",
            max_relative(mirrored.deflection, solution.deflection),
            maximum=1e-9,
        ),
        Measured(
            "centroids off their mirror images, m",
            largest(_centroid(mirrored_problem, mirrored) + _centroid(problem, solution)),
            maximum=1e-9,
        ),
        Measured("rigid gap of plain flanks off the wedge's, m", largest(plain + wedge), maximum=1e-12),
        Measured("first touch later than the wedge's, m", (solution.no_load + wedge).max(), maximum=1e-12),
    )


@SCENES.add(
    "single_slice",
    "One slice over the whole face: the load may not spread as it likes, and patches are as wide as the "
    "gear.",
    "Dividing slices frees the load: from three on STE falls everywhere (least complementary energy); one, "
    "which knows no free ends of the face, is within 5 % of nine.",
)
def _single_slice() -> Sequence[Measured]:
    """Spread the load evenly: one slice in three dimensions, then three, then nine."""
    full = contact_case(nominal_pair(), model="3d")
    position = even_positions(24)
    solved = [ContactCase(full.contact.in_slices(slices), full.model).solve(position) for slices in (1, 3, 9)]
    one, three, nine = (solution.deflection[:, 0] for _, solution in solved)
    return (
        *soundness(*solved[0], 8),
        Measured("least drop of STE as three slices are divided, m", np.min(three - nine), minimum=0.0),
        Measured(
            "mean of one slice over nine",
            one.mean() / nine.mean(),
            maximum=1.05,
            minimum=0.95,
        ),
    )


@SCENES.add(
    "identical_positions",
    "Positions given twice make spacings of zero.",
    "Equal positions have equal STE to the last bit, whatever stands beside them.",
)
def _duplicates() -> Sequence[Measured]:
    """Ask for the same position several times, in any order, alone and among others."""
    case = contact_case(nominal_pair())
    positions = np.array([0.3, 0.3, 0.0, 0.97, 0.3, 0.0, 0.5, 0.5])
    problem, together = case.solve(positions)
    single = [case.ste(np.array([x]))[0, 0] for x in positions]
    groups = [together.deflection[positions == x, 0] for x in np.unique(positions)]
    return (
        *soundness(problem, together),
        Measured(
            "spread over equal positions, m", max(float(np.ptp(group)) for group in groups), maximum=0.0
        ),
        Measured(
            "asked together or alone, difference in m",
            largest(together.deflection[:, 0] - single),
            maximum=1e-20,
        ),
    )


def _centroid(problem: ContactProblem, solution: ContactSolution) -> FloatArray:
    """Return the centroid of the load along the face, m."""
    force = solution.force[:, 0]
    return np.asarray(force @ problem.candidates.face_position / force.sum(axis=1))
