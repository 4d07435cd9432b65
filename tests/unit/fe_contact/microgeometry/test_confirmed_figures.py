"""Errors of largest pressure, K_Hbeta and root stress of a design cover finer discretizations of it."""

import math
from dataclasses import replace

import numpy as np
import pytest
from spur_gears import LONG_RELIEFS

from fe_contact import AnalysisOptions, Gear, GearPair, Limits, Run, Scatter
from fe_contact.microgeometry.confirmed_figures import REMAINING, confirmed_figures
from fe_contact.microgeometry.design_study import DesignSpace, design_study
from fe_contact.microgeometry.evaluator import Evaluator
from fe_contact.microgeometry.scatter import NO_SCATTER
from model_studies.stage_clock import StageClock

ON_FLANKS = "pressure", "face_load_factor"
DESIGN = {"pinion.helix_crowning": 4e-6, "pinion.tip_relief": 10e-6, "pinion.tip_relief_length": 1e-3}


def helical() -> Evaluator:
    """Misaligned by 8 µm, give or take 2."""
    angle = math.radians(20.0)
    pinion, wheel = (Gear(20, 3e-3, 24e-3, bore_diameter=30e-3, helix_angle=own) for own in (angle, -angle))
    pair = GearPair(pinion, wheel, 2.0 * pinion.reference_radius)
    space = DesignSpace(pair, DESIGN, Scatter(2e-6), 8e-6, 16, AnalysisOptions(level="draft"))
    return design_study(space, [150.0], [], StageClock(), Run()).evaluator


def spur(level: str, positions: int) -> Evaluator:
    options, limits = AnalysisOptions(level=level, model="plane_strain"), Limits(root_stress=1e9)
    space = DesignSpace(LONG_RELIEFS, {}, NO_SCATTER, 0.0, positions, options)
    return design_study(space, [200.0], [], StageClock(), Run(), limits=limits).evaluator


@pytest.mark.law
@pytest.mark.usefixtures("coarse_sectors")
def test_errors_cover_more_slices_and_positions():
    rough = helical()
    contact = rough.contact
    fewer = replace(rough, contact=contact.in_slices(contact.plan.discretization.slices // 2))
    stated = confirmed_figures(fewer, DESIGN, None)
    finer = rough.at(np.arange(32) / 32).evaluate(DESIGN)
    for name in ON_FLANKS:
        own, error = getattr(stated, name), getattr(stated, f"{name}_error")
        off = np.abs(getattr(finer, name) - own)
        assert off.max() > 1e-3 * own.max()  # there is something to cover
        assert np.all(off <= error) and np.all(error < 0.5 * own)  # told by three slices
    assert np.all(np.isnan(stated.root_stress_error))


@pytest.mark.law
def test_errors_of_a_draft_in_the_plane_cover_finer_meshes():
    stated = confirmed_figures(spur("draft", 64), {}, None)
    finer = spur("fine", 256).evaluate({})
    for name in REMAINING:
        own, error = getattr(stated, name), getattr(stated, f"{name}_error")
        assert np.all(np.abs(getattr(finer, name) - own) <= error + 1e-12 * own)
        assert np.all(error < 0.05 * own)
    assert stated.pressure_error.max() > 0.0 and stated.root_stress_error.max() > 0.0
    assert stated.face_load_factor_error.max() < 1e-12  # a plane has no face


def test_without_confirmation_no_error_is_told():
    figures = spur("draft", 16).evaluate({})
    assert all(np.all(np.isnan(getattr(figures, f"{name}_error"))) for name in REMAINING)
