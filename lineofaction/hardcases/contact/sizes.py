"""Very small and very large gears, narrow and wide faces, helix angles near zero and steep."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from fe_contact.geometry import Gear, GearPair
from lineofaction.hardcases.contact.contact_case import (
    NOMINAL_TORQUE,
    ContactCase,
    contact_case,
    even_positions,
    max_relative,
    mean_relative,
    nominal_gear,
    nominal_pair,
)
from lineofaction.hardcases.contact.laws import soundness
from lineofaction.hardcases.scene import Measured, Scenes, largest

SCENES = Scenes("contact")

_MODULE = 4e-3
_WIDTH = 25e-3
_OVER_PLANE = {"minimum": 1.0, "maximum": 1.0 / (1.0 - 0.3**2)}
"""Bounds of the STE over that of plane strain: plane strain and, with Poisson's ratio 0.3, plane stress."""


def _module_of(module: float) -> Sequence[Measured]:
    """Scale the nominal pair to another module, in the plane and in three dimensions."""
    scale = module / _MODULE
    figures = []
    for model in ("plane_strain", "3d"):
        plain, scaled = (_scaled_case(factor, model) for factor in (1.0, scale))
        position = even_positions(40)
        problem, solution = scaled.solve(position)
        expected = scale * plain.ste(position)
        figures += [
            *(replace(figure, name=f"{figure.name}, {model}") for figure in soundness(problem, solution)),
            Measured(
                f"STE over the scaled one, off by, {model}",
                max_relative(solution.deflection, expected),
                maximum=1e-7,
            ),
        ]
    return figures


for _module, _because in (
    (0.2e-3, "Elements of 1 µm: any length written into the mesher or the solver shows."),
    (40e-3, "Gears of 0.8 m: any length written into the mesher or the solver shows."),
):
    SCENES.add(
        f"module_{1e3 * _module:g}_mm",
        _because,
        "All lengths by s and forces by s^2: STE by s, in the plane and in three dimensions.",
    )(partial(_module_of, _module))


@SCENES.add(
    "helix_0.1_deg",
    "A tenth of a degree: contact lines enter the mesh nearly all at once, where a spur pair's do so "
    "exactly.",
    "The spur pair's mean within 0.2 %, no value below the spur pair's least, both hands alike.",
)
def _slight_helix() -> Sequence[Measured]:
    """Turn a spur pair by a tenth of a degree, to either hand."""
    position = even_positions(48)
    spur, right, left = (_helical(degrees) for degrees in (0.0, 0.1, -0.1))
    plain = spur.ste(position)[:, 0]
    problem, solution = right.solve(position)
    mirrored = left.ste(position)[:, 0]
    curve = solution.deflection[:, 0]
    return (
        *soundness(problem, solution, compared=8),
        Measured("mean STE against the spur pair's", mean_relative(curve, plain), maximum=2e-3),
        Measured("least slip below the spur pair's curve, m", np.max(plain.min() - curve), maximum=5e-8),
        Measured("left hand against right hand", max_relative(mirrored, curve), maximum=1e-9),
    )


@SCENES.add(
    "helix_40_deg",
    "At 40 degrees contact lines cross three teeth, and layers of elements are turned against each other.",
    "Both hands alike, periodic, load shares sum to one, two solvers agree.",
)
def _steep_helix() -> Sequence[Measured]:
    """Turn the teeth by 40 degrees."""
    position = even_positions(48)
    right, left = _helical(40.0), _helical(-40.0)
    problem, solution = right.solve(position)
    mirrored = left.ste(position)
    _, next_pitch = right.contact.solve(right.model, position + 1.0, right.plan.load)
    shares = (solution.force * problem.candidates.torque_share[:, None, :]).sum(axis=2) / right.plan.load
    curve = solution.deflection
    return (
        *soundness(problem, solution, compared=8),
        Measured("total contact ratio", right.pair.total_contact_ratio, minimum=2.0),
        Measured("left hand against right hand", max_relative(mirrored, curve), maximum=1e-9),
        Measured("STE one pitch further", max_relative(next_pitch.deflection, curve), maximum=1e-9),
        Measured("load shares off one", largest(shares - 1.0), maximum=1e-12),
    )


@SCENES.add(
    "face_0.3_and_30_modules",
    "A disc thinner than its teeth are thick, and a roller six times as long as its diameter is thick.",
    "The mean STE per unit of line load lies between plane strain and plane stress, the narrow one's higher.",
)
def _faces() -> Sequence[Measured]:
    """Compare gears of 0.3 and of 30 modules face width with the plane between them."""
    plane = contact_case(nominal_pair())
    position = even_positions(24)
    strain = plane.ste(position)[:, 0].mean()
    ratios, figures = [], []
    for width in (0.3 * _MODULE, 30.0 * _MODULE):
        case = contact_case(nominal_pair(face_width=width), [NOMINAL_TORQUE * width / _WIDTH], model="3d")
        problem, solution = case.solve(position)
        ratios.append(float(solution.deflection[:, 0].mean() / strain))
        figures += [
            replace(figure, name=f"{figure.name}, {width / _MODULE:g} modules")
            for figure in soundness(problem, solution, compared=6)
        ]
    return (
        *figures,
        Measured("0.3 modules: mean STE over plane strain", ratios[0], **_OVER_PLANE),
        Measured("30 modules: mean STE over plane strain", ratios[1], **_OVER_PLANE),
        Measured("narrow over wide", ratios[0] / ratios[1], minimum=1.0),
    )


def _scaled_case(scale: float, model: str) -> ContactCase:
    """Return the nominal pair with all lengths scaled, under the same strain."""
    gear = Gear(
        teeth=20, normal_module=scale * _MODULE, face_width=scale * _WIDTH, bore_diameter=scale * 40e-3
    )
    torques = NOMINAL_TORQUE * scale**3 * np.array([0.1, 1.0])
    return contact_case(GearPair(gear, gear, scale * 80e-3), torques, model=model)


def _helical(degrees: float) -> ContactCase:
    """Return gears of the nominal teeth and another helix, at their own center distance."""
    helix = math.radians(degrees)
    pair = GearPair(nominal_gear(helix_angle=helix), nominal_gear(helix_angle=-helix))
    return contact_case(pair, model="3d")
