"""STE converges under mesh refinement at the element's rate, and does not ripple with the element length."""

import dataclasses
from pathlib import Path

import numpy as np
import pytest
from spur_gears import PAIR

from fe_contact.analysis.pairs.pair_contact import pair_contact
from fe_contact.effects import EFFECTS, ContactScene, compose
from fe_contact.options import AnalysisOptions
from fe_contact.planning.plan import make_plan

LOAD = np.array([100.0, 400.0]) / 37.588e-3  # N, 100 and 400 N m


@pytest.fixture(scope="module")
def contact(tmp_path_factory):
    """Return the STE on the standard mesh refined by a factor, patches kept or of a half-width in modules."""
    cache: Path = tmp_path_factory.mktemp("compliance")
    pair = PAIR
    model, _ = compose(ContactScene(pair, pair.torque(LOAD), EFFECTS), {})
    plan = make_plan(pair, LOAD, AnalysisOptions(), model)

    def solve(factor, position, load, patch=None):
        first, second = (recipe.refined(factor) for recipe in plan.discretization.recipes)
        made = dataclasses.replace(plan.discretization, recipes=(first, second))
        rule = plan.patch
        if patch is not None:
            rule = dataclasses.replace(rule, half_width=patch * pair.pinion.normal_module)
        contact = pair_contact(pair, dataclasses.replace(plan, discretization=made, patch=rule), cache)
        return contact.solve(model, position, load)[1].deflection

    return solve


def test_rate_and_level(contact, record_figure):
    """Halving the elements divides the error at least fourfold: quadratic elements, Galerkin loads."""
    position = np.array([0.0, 0.1, 0.3, 0.5])
    ste = [contact(factor, position, LOAD) for factor in (0.25, 0.5, 1.0)]
    first, second = np.abs(ste[1] - ste[0]).max(), np.abs(ste[2] - ste[1]).max()
    rate = float(np.log2(first / second))
    left = float(second / (2**rate - 1.0) / ste[2].max())
    record_figure("STE under mesh refinement, rate", rate, "at least 2", "-", "quadratic elements")
    name = "STE, discretization error of the standard mesh"
    record_figure(name, 100 * left, "below 0.1 %", "%", "Richardson")
    assert rate > 2.0
    assert left < 1e-3


def test_width_of_load_patches_cancels(contact, record_figure):
    """Patches twice as wide as another leave the STE: the part of first order in the width is taken off."""
    position = np.array([0.0, 0.1, 0.4, 0.5])
    wide, narrow = (contact(2.0, position, LOAD, patch) for patch in (0.15, 0.075))
    change = float(np.abs(wide / narrow - 1.0).max())
    record_figure("STE by patches of 0.15 and 0.075 modules", 100 * change, "below 0.03 %", "%", "law")
    assert change < 3e-4


@pytest.mark.parametrize(("low", "high", "name"), [(-0.14, 0.14, "single"), (0.26, 0.74, "double")])
def test_position_noise(contact, record_figure, low, high, name):
    """Between the handovers the curve is smooth: what a polynomial of degree 10 leaves is noise."""
    position = np.linspace(low, high, 400)
    ste = contact(1.0, position, LOAD[:1])[:, 0]
    noise = float(np.std(ste - np.polynomial.Chebyshev.fit(position, ste, 10)(position)))
    record_figure(
        f"position noise in {name} contact, 100 N m, rms", 1e9 * noise, "below 2 nm", "nm", "target"
    )
    assert noise < 0.5e-9
