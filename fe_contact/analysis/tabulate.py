"""From a contact solution to the arrays of the STE database."""

from __future__ import annotations

from typing import Any

import numpy as np

from fe_contact.contact import Candidates, ContactSolution
from fe_contact.geometry import GearPair
from fe_contact.hertz import peak_pressure
from fe_contact.ste import PairFacts
from fe_contact.types import Status


def pair_facts(pair: GearPair) -> PairFacts:
    """Closed-form facts of the pair that users of the table need."""
    return PairFacts(
        teeth=(pair.pinion.teeth, pair.wheel.teeth),
        base_radius=(pair.pinion.base_radius, pair.wheel.base_radius),
        base_pitch=pair.base_pitch,
        base_helix_angle=abs(pair.base_helix_angle),
        center_distance=pair.center_distance,
        working_pressure_angle=pair.working_pressure_angle,
        face_width=pair.face_width,
        helix_hand=int(np.sign(pair.base_helix_angle)),
    )


def contact_fields(candidates: Candidates, solution: ContactSolution, modulus: float) -> dict[str, Any]:
    """Arrays (P, F, ...) of one misalignment and centre distance, by name in the database.

    The peak pressure is Hertz's for the load and curvature of each contact; at a tip edge the true pressure
    is singular.
    """
    good = solution.status == Status.CONVERGED
    loaded = solution.force * candidates.torque_share[:, None, :]
    total = np.where(good, loaded.sum(axis=2), 1.0)
    line_load = solution.force / candidates.width
    pressure = peak_pressure(line_load, candidates.radius[:, None, :], modulus)
    fields = {
        "static_transmission_error": solution.deflection,
        "tangent_compliance": solution.tangent,
        "load_share": loaded / total[..., None],
        "face_centroid": np.zeros_like(solution.deflection),
        "max_pressure": np.where(good, pressure.max(axis=2), np.nan),
        "pairs_in_contact": (solution.force > 0.0).sum(axis=2),
        "status": solution.status,
        "residuals": solution.residuals,
    }
    return {name: values[:, :, None, None] for name, values in fields.items()}


def support_fields(solution: ContactSolution) -> dict[str, Any]:
    """Support loads that converged everywhere, and their arrays (P, S, 1, 1)."""
    good = np.all(solution.status == Status.CONVERGED, axis=0)
    fields = {
        "support_transmission_error": solution.deflection,
        "support_tangent_compliance": solution.tangent,
        "support_pairs_in_contact": (solution.force > 0.0).sum(axis=2),
    }
    return {"support_force": solution.load[good]} | {
        name: values[:, good, None, None] for name, values in fields.items()
    }
