"""Materials and bodies far from solid steel."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from fe_contact.geometry import Gear, GearBlank, GearPair
from fe_contact.material import Material
from fe_contact.types import FloatArray
from lineofaction.hardcases.contact.contact_case import (
    NOMINAL_TORQUE,
    ContactCase,
    contact_case,
    even_positions,
    mean_relative,
    nominal_gear,
    nominal_pair,
)
from lineofaction.hardcases.contact.laws import soundness
from lineofaction.hardcases.scene import Measured, Scenes

SCENES = Scenes("contact")

_PLASTIC = Material(youngs_modulus=2.1e9, poissons_ratio=0.3)

_RUBBERY = Material(youngs_modulus=210e9, poissons_ratio=0.49)


@SCENES.add(
    "plastic_on_steel",
    "Moduli of 2.1 and 210 GPa: one gear does all the bending, contact strips are ten times as wide, and "
    "compliances differ by a hundred.",
    "The mean STE is below that of two equal gears of the mean compliance (unlike springs in parallel share"
    " the load better), by less than 10 %, and the same whichever gear is the soft one; two solvers agree.",
)
def _plastic_on_steel() -> Sequence[Measured]:
    """Let a steel pinion drive a wheel a hundred times as soft, and compare with two gears half as soft."""
    steel, soft = nominal_gear(), nominal_gear(material=_PLASTIC)
    mean = nominal_gear(material=Material(2.0 / (1.0 / 210e9 + 1.0 / 2.1e9)))
    position = even_positions(96)
    pairs = (GearPair(steel, soft, 80e-3), GearPair(soft, steel, 80e-3), GearPair(mean, mean, 80e-3))
    driven, driving, equal = (contact_case(pair, NOMINAL_TORQUE * np.array([1e-3, 0.02])) for pair in pairs)
    problem, solution = driven.solve(position)
    reversed_ste = driving.ste((1.0 - position) % 1.0)  # equal teeth: the pair seen from its other gear
    halves = equal.ste(position)
    return (
        *soundness(problem, solution),
        Measured(
            "mean STE over that of two gears of the mean compliance",
            solution.deflection[:, 1].mean() / halves[:, 1].mean(),
            maximum=1.0,
            minimum=0.9,
        ),
        Measured(
            "soft gear driving, position turned: mean STE, relative difference",
            mean_relative(reversed_ste[:, 1], solution.deflection[:, 1]),
            maximum=5e-3,
        ),
    )


@SCENES.add(
    "poisson_0.49",
    "Poisson's ratio 0.49 in plane strain: elements of low order lock, and read far too stiff.",
    "Three meshes in the plane and two in three dimensions agree.",
)
def _nearly_incompressible() -> Sequence[Measured]:
    """Give both gears Poisson's ratio 0.49 in plane strain, on three meshes and in three dimensions."""
    pair = nominal_pair(material=_RUBBERY)
    position = even_positions(96)
    levels = [contact_case(pair, level=level) for level in ("draft", "standard", "fine")]
    solid = [contact_case(pair, model="3d", level=level) for level in ("draft", "standard")]
    means = [_mean(case, position) for case in levels]
    solids = [_mean(case, position) for case in solid]
    problem, solution = levels[-1].solve(position)
    return (
        *soundness(problem, solution),
        Measured("mean STE, draft against fine mesh", abs(means[0] / means[2] - 1.0), maximum=5e-3),
        Measured("mean STE, standard against fine mesh", abs(means[1] / means[2] - 1.0), maximum=2e-3),
        Measured(
            "in three dimensions, draft against standard", abs(solids[0] / solids[1] - 1.0), maximum=2e-2
        ),
    )


@SCENES.add(
    "thin_rim",
    "A rim of half a module over a web of 4 mm bends like a belt under the teeth.",
    "STE grows with every bit taken off the rim; two meshes agree; two solvers agree.",
)
def _thin_rim() -> Sequence[Measured]:
    """Hang the teeth on ever thinner rims over a narrow web."""
    position = even_positions(48)
    thick = [9.0, 2.0, 0.5]
    cases = [contact_case(_on_rim(modules), effects={"thin_rim": "on"}) for modules in thick]
    means = [_mean(case, position) for case in cases]
    problem, solution = cases[-1].solve(position)
    finer = contact_case(_on_rim(thick[-1]), level="standard", effects={"thin_rim": "on"})
    growth = [after / before for before, after in pairwise(means)]
    return (
        *soundness(problem, solution, 8),
        Measured("growth of mean STE from rim to thinner rim, least", min(growth), minimum=1.0),
        Measured("mean STE at half a module over the thickest rim", means[-1] / means[0], minimum=1.1),
        Measured(
            "half a module: mean STE of two meshes apart",
            abs(means[-1] / _mean(finer, position) - 1.0),
            maximum=1e-2,
        ),
    )


def _on_rim(modules: float) -> GearPair:
    """Return 40 teeth on a rim of so many modules, driven by 20."""
    blank = GearBlank(rim_thickness=modules * 4e-3, web_thickness=4e-3)
    wheel = Gear(teeth=40, normal_module=4e-3, face_width=25e-3, bore_diameter=60e-3, blank=blank)
    return GearPair(nominal_gear(), wheel)


def _mean(case: ContactCase, position: FloatArray) -> float:
    """Return the mean STE at the highest load, m."""
    return float(case.ste(position)[:, -1].mean())
