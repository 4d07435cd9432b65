"""Contact at zero load, and at loads over seven decades."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fe_contact.analysis.analyze import analyze
from fe_contact.errors import InputError
from fe_contact.geometry import FlankModification
from lineofaction.hardcases.contact.contact_case import (
    NOMINAL_TORQUE,
    contact_case,
    even_positions,
    mean_relative,
    nominal_pair,
    range_off,
)
from lineofaction.hardcases.contact.laws import soundness
from lineofaction.hardcases.scene import Measured, Scenes

SCENES = Scenes("contact")

_DECADES = np.geomspace(1e-4, 1e3, 29)


@SCENES.add(
    "load_seven_decades",
    "One table holds 1e-4 and 1e3 times the nominal load: patches fit for the highest load are wider than "
    "the tooth, and forces differ by 1e7.",
    "STE grows with load, the tangent compliance never does, two solvers agree, and the curve at nominal "
    "load is that of a table which holds nothing else.",
)
def _seven_decades() -> Sequence[Measured]:
    """Solve one table over seven decades of load, and its nominal curve alone."""
    wide = contact_case(nominal_pair(), NOMINAL_TORQUE * _DECADES)
    problem, solution = wide.solve(even_positions(48))
    single = contact_case(nominal_pair())
    nominal = single.ste(even_positions(48))[:, 0]
    at_nominal = solution.deflection[:, int(np.argmin(np.abs(_DECADES - 1.0)))]
    elastic = solution.deflection - solution.no_load[:, None]
    stiffening = np.diff(solution.tangent, axis=1) / solution.tangent[:, :-1]
    return (
        *soundness(problem, solution),
        Measured(
            "least growth of STE from load to load",
            np.min(elastic[:, 1:] / elastic[:, :-1]),
            minimum=1.0 + 1e-9,
        ),
        Measured("largest growth of the tangent compliance", stiffening.max(), maximum=1e-9),
        Measured(
            "mean STE at nominal load, against a table of that load alone",
            mean_relative(at_nominal, nominal),
            maximum=5e-3,
        ),
        Measured("peak-to-peak likewise", range_off(at_nominal, nominal), maximum=2e-2),
        Measured("points whose contact outgrew its patch", solution.beyond.sum()),
    )


@SCENES.add(
    "zero_load",
    "At zero load no tangent stiffness exists and every figure is 0/0.",
    "STE tends to the rigid gap, where the table's force is exactly zero; a load of zero is refused by name.",
)
def _zero_load() -> Sequence[Measured]:
    """Go to zero load in the solver, in the table and at the entry point."""
    relief = FlankModification(tip_relief=20e-6, tip_relief_length=2e-3, profile_crowning=5e-6)
    pair = nominal_pair(modification=relief)
    case = contact_case(pair, NOMINAL_TORQUE * np.geomspace(1e-15, 1.0, 6))
    problem, solution = case.solve(even_positions(48))
    rest = (solution.deflection[:, 0] - solution.no_load) / solution.deflection[:, -1]
    table = analyze(pair, torques=[NOMINAL_TORQUE], level="draft", positions=48, receipt="minimal")
    at_rest = table.ste(table.position, 0.0)
    lift_off = table.no_load_transmission_error[:, 0, 0]
    try:
        analyze(pair, torques=[0.0, NOMINAL_TORQUE])
        refused = ""
    except InputError as error:
        refused = error.field
    return (
        *soundness(problem, solution),
        Measured(
            "STE left at 1e-15 of the load, over its nominal value", rest.max(), maximum=1e-12, minimum=0.0
        ),
        Measured("table at zero force against the rigid gap, m", np.ptp(at_rest - lift_off), maximum=1e-16),
        Measured("force at lift-off, N", table.force_at(table.position, lift_off).force.max(), maximum=0.0),
        Measured("zero in a list of torques refused by its name", refused == "torques[0]", minimum=1.0),
    )
