"""Laws of mechanics on flank results: planted faults break them, and sound results stay within bounds."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import pytest

from fe_contact import AnalysisOptions, FlankModification, Gear, GearPair, OperatingPoint, flank_results
from fe_contact.analysis.checks.table_laws import require_laws
from fe_contact.analysis.flanks import flank_results as flank_analysis
from fe_contact.analysis.flanks.flank_laws import check_flank_laws
from fe_contact.analysis.flanks.load_distribution import LoadDistribution
from fe_contact.analysis.flanks.solved_operating_point import solved_point
from fe_contact.analysis.request.request_check import as_checked
from fe_contact.contact import ContactProblem
from fe_contact.errors import SolveError
from fe_contact.options import Run
from model_studies.stage_clock import StageClock

pytestmark = pytest.mark.usefixtures("coarse_sectors")

AT = np.arange(8) / 8.0
SPOT = 3
RELIEF = FlankModification(tip_relief=15e-6, tip_relief_length=1.5e-3)


def spur() -> GearPair:
    gear = Gear(20, 4e-3, 25e-3, 40e-3, modification=RELIEF)
    return GearPair(gear, replace(gear, modification=FlankModification()), 80e-3)


def helical() -> GearPair:
    pinion = Gear(19, 3e-3, 20e-3, 30e-3, helix_angle=math.radians(20.0))
    return GearPair(pinion, replace(pinion, teeth=26, helix_angle=-pinion.helix_angle))


Solved = tuple[LoadDistribution, ContactProblem]


def solved(pair: GearPair, model: str, misalignment: float) -> Solved:
    point = OperatingPoint(torque=90.0, misalignment=misalignment)
    checked = as_checked(pair, point, AnalysisOptions(level="draft", model=model))
    found, _ = solved_point(checked, AT, StageClock(), Run())
    made = flank_analysis.load_distribution(
        found.contact.pair, found.problem, found.solution, misalignment=misalignment
    )
    return made, found.problem


@pytest.fixture(scope="module")
def relieved(coarse_sectors):
    return solved(spur(), "3d", 20e-6)


@dataclass(frozen=True)
class Break:
    """A fault at one position of the results, and the law that it breaks."""

    law: str
    plant: Callable[[LoadDistribution], LoadDistribution]


def at_spot(name: str, change: Callable[[np.ndarray], np.ndarray]) -> Callable[..., LoadDistribution]:
    def plant(flanks):
        values = np.array(getattr(flanks, name))
        values[SPOT] = change(values[SPOT])
        return replace(flanks, **{name: values})

    return plant


def pulling(force: np.ndarray) -> np.ndarray:
    """Let one stretch pull by a millionth of the load, which others carry."""
    pull = 1e-6 * force.sum()
    first, last = (tuple(index) for index in np.argwhere(force == 0.0)[[0, -1]])
    changed = force.copy()
    changed[first], changed[last] = -pull, pull
    return changed


def past_the_face(force: np.ndarray) -> np.ndarray:
    """Lay all of it on one end and pull at the other."""
    changed = np.zeros(force.shape)
    changed[0, 0], changed[0, -1] = 2.0 * force.sum(), -force.sum()
    return changed


BREAKS = {
    "a stretch that pulls": Break("contacts push", at_spot("force", pulling)),
    "a pressure below zero": Break("contacts push", at_spot("pressure", lambda x: x - 1e-6 * x.max())),
    "forces beyond the torque": Break("balance of moments", at_spot("force", lambda x: x * (1.0 + 1e-6))),
    "a lever of another pair": Break("balance of moments", at_spot("lever", lambda x: x * 0.999)),
    "no number": Break("balance of moments", at_spot("force", lambda x: x * np.nan)),
    "a face that runs the other way": Break(
        "balance of moments", lambda flanks: replace(flanks, face_position=flanks.face_position[::-1])
    ),
    "stretches of another face": Break(
        "line loads carry the load", lambda flanks: replace(flanks, slice_width=1.001 * flanks.slice_width)
    ),
    "a centroid beside the face": Break("load within the face", at_spot("force", past_the_face)),
    "flanks inside each other": Break("flanks do not overlap", at_spot("gap", lambda x: x - 1e-9)),
    "a gap under load": Break("flanks touch where they carry", at_spot("gap", lambda x: x + 1e-9)),
    "pressure too low for its load": Break(
        "pressure carries the line load", at_spot("pressure", lambda x: 0.4 * x)
    ),
    "pressure of a sharper flank": Break(
        "pressure of the sharpest contact", at_spot("pressure", lambda x: 2.5 * x)
    ),
}


@pytest.mark.parametrize("name", BREAKS)
def test_a_planted_break_makes_flank_results_fail(relieved, name):
    flanks, problem = relieved
    require_laws(check_flank_laws(flanks, problem), flanks, "load distribution")
    broken = BREAKS[name].plant(flanks)
    with pytest.raises(SolveError, match=f"load distribution breaks a law.*{BREAKS[name].law}: ") as raised:
        require_laws(check_flank_laws(broken, problem), broken, "load distribution")
    assert raised.value.partial is broken


@pytest.mark.parametrize("share", [0.99, 1.01])
def test_the_pressure_of_plain_flanks_is_bounded_to_a_percent(share):
    flanks, problem = solved(helical(), "3d", 10e-6)
    broken = replace(flanks, pressure=share * flanks.pressure)
    laws = {law.law for law in check_flank_laws(broken, problem) if law.broken}
    assert laws == {"pressure carries the line load" if share < 1.0 else "pressure of the sharpest contact"}


@pytest.mark.parametrize(
    ("pair", "model", "misalignment"),
    [(spur, "plane_strain", 0.0), (spur, "3d", -15e-6), (helical, "3d", -15e-6), (helical, "3d", 40e-6)],
)
def test_sound_results_take_little_of_the_room_of_balances(pair, model, misalignment):
    laws = check_flank_laws(*solved(pair(), model, misalignment))
    assert not [law.text for law in laws if law.broken]
    balances = [law.ratio for law in laws if "balance" in law.law or "carry the load" in law.law]
    assert len(balances) == 3
    assert max(balances) < 0.2


def test_flank_results_that_break_a_law_are_none(monkeypatch):
    original = flank_analysis.load_distribution

    def faulty(*args, **kwargs):
        return BREAKS["forces beyond the torque"].plant(original(*args, **kwargs))

    monkeypatch.setattr(flank_analysis, "load_distribution", faulty)
    point, options = OperatingPoint(torque=90.0), AnalysisOptions(level="draft", model="plane_strain")
    with pytest.raises(SolveError, match=r"balance of moments: .* at position 0\.375, bound"):
        flank_results(spur(), point, options, at=AT)


def test_the_receipt_has_the_worst_place_under_each_law():
    point, options = OperatingPoint(torque=90.0), AnalysisOptions(level="draft", model="plane_strain")
    laws = flank_results(spur(), point, options, at=AT).metadata.receipt["laws"]
    assert {law["law"] for law in laws} >= {fault.law for fault in BREAKS.values()}
    assert all(0.0 <= law["ratio"] <= 1.0 for law in laws)


@pytest.mark.parametrize(("shape", "kinked"), [("linear", True), ("parabolic", False)])
def test_a_kink_under_the_largest_pressure_names_the_strip(shape, kinked):
    """Pairs at the start of a relief: the strip on it is that of pressure and line load."""
    relief = FlankModification(tip_relief=15e-6, tip_relief_length=1.5e-3, tip_relief_shape=shape)
    gear = Gear(20, 3e-3, 12e-3, 30e-3, modification=relief)
    point, options = OperatingPoint(torque=100.0), AnalysisOptions(level="draft", model="plane_strain")
    found = flank_results(GearPair(gear, gear, 60e-3), point, options, at=[0.44])
    place = np.unravel_index(found.clear_pressure.argmax(), found.force.shape)
    strip = 4.0 * found.line_load[place] / (math.pi * found.pressure[place])
    assert found.errors.kink_length == pytest.approx(strip if kinked else 0.0, rel=1e-9)
