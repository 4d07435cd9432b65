"""The amplitude of one harmonic as an objective, and designs on the grid of a drawing."""

from typing import Any

import numpy as np
import pytest
from analysis_requests import design_request
from spur_gears import LONG_RELIEFS

from fe_contact import DesignVariable, Estimate, Search, analyze, optimize
from fe_contact.errors import InputError
from fe_contact.microgeometry.conclusion import level_change
from fe_contact.microgeometry.objective import HarmonicAmplitude, Worst
from fe_contact.microgeometry.optimization import Outcome
from fe_contact.microgeometry.search_methods import NelderMead
from fe_contact.microgeometry.variables import modified

TORQUE, HARMONIC = 200.0, 2
DRAFT: dict[str, Any] = {"level": "draft", "model": "plane_strain"}
STEP = 2.5e-6
FREE = (DesignVariable("pinion.tip_relief", 0.0, 60e-6), DesignVariable("wheel.tip_relief", 0.0, 60e-6))
GRID = {variable.name: np.arange(0.0, 60.1e-6, STEP) for variable in FREE}


@pytest.mark.law
@pytest.mark.parametrize("period", [1, 3])
@pytest.mark.parametrize("even", [True, False])
def test_the_curve_of_a_harmonic_spans_its_amplitude(period, *, even):
    position = np.arange(64) / 64
    if not even:
        position = np.sort(np.concatenate([position, np.linspace(0.303, 0.397, 40)]))
    places = (position + np.arange(period)[:, None]).ravel()
    sizes = np.array([2e-6, 0.5e-6, 0.1e-6])
    ste = 20e-6 + sum(size * np.cos(2.0 * np.pi * n * places + n) for n, size in enumerate(sizes, 1))
    curves = np.stack([ste, 3.0 * ste], axis=-1)[None]  # one node, two loads
    for harmonic, size in enumerate(sizes, 1):
        counted = HarmonicAmplitude(harmonic).counted(curves, position)
        assert np.ptp(counted, axis=1)[0] == pytest.approx([size, 3.0 * size], rel=0.02, abs=1e-10)


@pytest.mark.parametrize(
    ("after", "said"),
    [
        (Estimate(20e-9, 1e-9, "m"), "13.98 ± 0.52 dB"),
        (Estimate(200e-9, 1e-9, "m"), "6.02 ± 0.13 dB"),
        (Estimate(2e-9, 3e-9, "m"), "at least 26 dB"),  # 100 - 1 to 2 + 3 nm
        (Estimate(99e-9, 1e-9, "m"), ""),
    ],
)
def test_the_change_of_a_level_has_the_errors_of_both_amplitudes(after, said):
    assert level_change(Estimate(100e-9, 1e-9, "m"), after) == said


def test_a_harmonic_that_no_curve_has_is_refused():
    with pytest.raises(InputError, match=r"objective\.harmonic"):
        HarmonicAmplitude(0, Worst()).check(1)


@pytest.mark.law
def test_the_search_lowers_the_harmonic_and_ends_on_the_grid_of_the_drawing():
    search = Search(NelderMead(), evaluations=80, positions=32)
    request = design_request(
        LONG_RELIEFS,
        [TORQUE],
        FREE,
        search=search,
        map_torques=[TORQUE],
        objective=HarmonicAmplitude(HARMONIC),
        grid=GRID,
        **DRAFT,
    )
    found = optimize(request)
    assert found.outcome is Outcome.IMPROVED
    for name, value in found.optimum.values.items():
        assert np.abs(GRID[name] - value).min() < 1e-12, name
    for design in (found.start, found.optimum):
        table = analyze(modified(LONG_RELIEFS, design.values), torques=[TORQUE], **DRAFT)
        harmonic = table.harmonics(torque=TORQUE)[HARMONIC - 1]
        assert abs(design.objective.value - harmonic.value) <= harmonic.error
        assert design.objective.error == pytest.approx(harmonic.error, rel=1e-2)
    teeth = LONG_RELIEFS.pinion.teeth
    words = f"order {2.0 * teeth} of the pinion, harmonic 2, at 200 N m: falls by "
    assert found.reason.startswith(words) and " dB, " in found.reason
