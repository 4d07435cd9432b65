"""What rounding leaves of a compliance, and how thin a disc may be."""

from __future__ import annotations

import math

import numpy as np
import pytest

from fe_contact import Gear, GearPair
from fe_contact.analysis.request.request_check import check_request
from fe_contact.compliance import flank_compliance_3d
from fe_contact.compliance.flank import (
    EPSILON,
    LARGEST_ROUNDING,
    _disc_rounding,
    least_face_width,
    left_by_rounding,
)
from fe_contact.errors import InputError, SolveError
from fe_contact.material import STEEL
from fe_contact.mesh import SectorRecipe
from fe_contact.options import AnalysisOptions, TableAxes


def disc(modules: float, helix: float = 0.3, teeth: int = 40) -> Gear:
    """Teeth on a small bore, this wide."""
    return Gear(
        teeth=teeth,
        normal_module=4e-3,
        face_width=modules * 4e-3,
        bore_diameter=teeth * 0.4e-3,
        helix_angle=helix,
    )


def slenderness(gear: Gear) -> float:
    return (gear.root_radius - gear.held_radius) / gear.face_width


def test_a_chain_of_springs_keeps_what_it_must() -> None:
    """Springs k between stiff ones, moved as a whole: K_ii u_i^2 is large, what is strained is little."""
    stiff, soft, count = 1e6, 1.0, 40
    matrix = stiff * (2.0 * np.eye(count) - np.eye(count, k=1) - np.eye(count, k=-1))
    matrix[0, 0], matrix[-1, -1] = stiff + soft, stiff
    load = np.zeros(count)
    load[-1] = 1.0
    u = np.linalg.solve(matrix, load)
    residual, energy = left_by_rounding(np.diag(matrix), u, load, float(u @ load))
    assert energy == pytest.approx(EPSILON * 2.0 * stiff / soft * (count - 1), rel=1e-3)
    assert np.linalg.norm(load - matrix @ u) < residual
    assert abs(float(u @ matrix @ u - u @ load)) / float(u @ load) < energy
    # the closed form: the soft spring, and the stiff ones in series
    assert u[-1] == pytest.approx(1.0 / soft + (count - 1) / stiff, rel=energy)


@pytest.mark.law
@pytest.mark.parametrize(("helix", "modules", "power"), [(0.3, 0.5, 4.0), (0.0, 0.1, 2.0)])
def test_rounding_grows_as_a_helical_disc_bends_as_a_plate(
    helix: float, modules: float, power: float
) -> None:
    """(D/w)^4 with a helix, whose axial force bends the disc; (D/w)^2 without."""
    wide, thin = disc(modules, helix, 20), disc(0.5 * modules, helix, 20)
    found = [flank_compliance_3d(gear, SectorRecipe.draft(gear), reach=0).checks for gear in (wide, thin)]
    quotient = found[1].energy_rounding / found[0].energy_rounding
    assert math.log2(quotient) == pytest.approx(power, abs=0.3)
    layers = SectorRecipe.draft(thin).layers
    predicted = _disc_rounding(slenderness(thin), helix, layers, STEEL)
    assert 1.0 / 3.0 < predicted / found[1].energy_rounding < 3.0


@pytest.mark.law
def test_a_disc_as_thin_as_allowed_is_computed_and_a_thinner_one_refused() -> None:
    layers = SectorRecipe.draft(disc(1.0)).layers
    least = least_face_width(disc(1.0), layers) / 4e-3
    assert _disc_rounding(slenderness(disc(least)), 0.3, layers, STEEL) == pytest.approx(LARGEST_ROUNDING)
    allowed, thinner = disc(1.001 * least), disc(0.999 * least)
    check_request(
        GearPair(allowed, mate_of(allowed)),
        TableAxes(torques=[1.0]),
        AnalysisOptions(model="3d", level="draft"),
    )
    assert flank_compliance_3d(allowed, SectorRecipe.draft(allowed), reach=0).checks.energy < LARGEST_ROUNDING
    with pytest.raises(InputError, match="bends as a plate under the axial force") as refusal:
        check_request(
            GearPair(thinner, mate_of(thinner)),
            TableAxes(torques=[1.0]),
            AnalysisOptions(model="3d", level="draft"),
        )
    assert refusal.value.field == "pinion.face_width"


def mate_of(gear: Gear) -> Gear:
    return disc(gear.face_width / 4e-3, -gear.helix_angle)


@pytest.mark.law
def test_a_body_beyond_the_bound_names_rounding() -> None:
    gear = disc(0.1, teeth=20)
    with pytest.raises(SolveError, match=r"rounding may change it by .* Widen the face"):
        flank_compliance_3d(gear, SectorRecipe.draft(gear), reach=0)
