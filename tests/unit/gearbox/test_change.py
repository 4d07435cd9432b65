"""What a change of flanks brings: laws of levels over one sample of tolerances."""

import copy
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from small_inputs import small_inputs

from fe_contact.ste import SteDatabase
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.registry import change, response, scatter
from lineofaction.gearbox.studies.change.result import FlankChange
from lineofaction.gearbox.studies.change.sound_flanks import HeardFlanks

Json = dict[str, Any]
PAIRS = 12
HALF: Json = {"name": "half", "factor": 0.5}
QUESTION: Json = {"speed_rpm": [300.0, 3000.0], "orders": 4, "load_cases": [HALF, {"name": "whole"}]}


def scene() -> Json:
    """At as many positions as condensed gears are solved at: what is between 16 is heard at order 4."""
    own: Json = small_inputs("modes")["scene"]
    own["meshes"][0]["case"]["accuracy"]["positions"] = 192
    return own


def case(**pinion: float) -> Json:
    own = copy.deepcopy(scene()["meshes"][0]["case"])
    own["pair"]["pinion"] = own["pair"]["pinion"] | pinion
    return own


RELIEVED = case(tip_relief_um=3.0, tip_relief_length_mm=0.4)


def rippling(table: SteDatabase, amplitude: float) -> SteDatabase:
    """Return a table that is the same at all positions but for a wave of its transmission error, m."""
    arrays = {}
    for name, dimensions in table.stored.items():
        array = getattr(table, name)
        if dimensions[:1] == ("position",) and array.ndim > 1 and array.size:
            flat = array.mean(axis=0) if array.dtype.kind == "f" else array.max(axis=0)
            arrays[name] = np.broadcast_to(flat, array.shape).astype(array.dtype)
            if name.endswith("transmission_error"):
                wave = amplitude * np.cos(2.0 * np.pi * table.position)
                arrays[name] = arrays[name] + wave.reshape(-1, *(1,) * (array.ndim - 1))
    return replace(table, **arrays)


def compared(before: Json | None, after: Json, **question: Any) -> FlankChange:
    tolerances = {"samples": PAIRS, "tolerance_class": 3}
    result: FlankChange = change(
        scene(), {"before": before, "after": after, "tolerances": tolerances, **QUESTION, **question}
    )
    return result


@cache
def relieved() -> FlankChange:
    return compared(None, RELIEVED)


def test_equal_flanks_change_nothing_of_any_pair():
    same = compared(case(), case())
    assert np.array_equal(same.before.pairs, same.after.pairs)
    assert not same.change.any() and not same.louder_share.any() and not list(same.louder())
    assert same.verdict().startswith("No change")


@pytest.mark.law
def test_levels_of_a_draft_differ_from_finer_ones_by_no_more_than_their_errors():
    """As designed and the change, of all orders and of those within 25 dB; bands hold the errors."""
    found = {}
    for level in ("draft", "standard"):
        own, after = scene(), copy.deepcopy(RELIEVED)
        for each in (own["meshes"][0]["case"], after):
            each["accuracy"] |= {"level": level, "receipt": "full"}
        found[level] = change(own, {"after": after, "tolerances": {"samples": 2}, **QUESTION})
    rough, fine = found["draft"], found["standard"]
    loud = fine.before.nominal > fine.before.nominal[:, :1] - 25.0
    for side in ("before", "after"):
        low, high = getattr(rough, side).error + getattr(fine, side).error
        off = getattr(fine, side).nominal - getattr(rough, side).nominal
        assert np.all((off >= -low)[loud]) and np.all((off <= high)[loud])
        assert np.all(high[loud] > 0.0)
        low, median, high = getattr(rough, side).quantiles()
        assert np.all(median - low >= getattr(rough, side).error[0] * (1.0 - 1e-9))


@pytest.mark.law
def test_all_orders_are_those_of_the_mesh():
    """What an unbalance excites at the order of its shaft is heard with any flanks, and not compared."""
    own = scene()
    own["unbalances"] = [{"name": "heavy", "shaft": "input", "position_mm": 100.0, "amount_g_mm": 100.0}]
    found = change(own, {"after": RELIEVED, "tolerances": {"samples": 2}, **QUESTION})
    together = 10.0 * np.log10(np.sum(10.0 ** (0.1 * found.before.nominal[:, 1:]), axis=1))
    assert np.all(found.before.nominal[:, 0] <= together + 1e-9)  # the loudest of each at speeds of its own
    assert np.all(found.before.nominal[:, 0] >= found.before.nominal[:, 1:].max(axis=1) - 1e-9)


def test_the_other_way_round_changes_the_sign():
    """Each level is one of a pair: it does not depend on which design the transfer functions are about."""
    back = compared(RELIEVED, case())
    np.testing.assert_allclose(back.change, -relieved().change, atol=1e-6)
    np.testing.assert_allclose(back.nominal_change, -relieved().nominal_change, atol=1e-6)


def test_the_same_deviations_leave_less_spread_than_two_samples():
    own = relieved()
    before, after = own.before.pairs[:, :, 0], own.after.pairs[:, :, 0]
    together = (after - before).std(axis=0)
    apart = np.sqrt(before.var(axis=0) + after.var(axis=0))
    assert np.all(together < apart)


def test_the_sample_is_that_of_the_tolerances_of_the_case():
    drawn = scatter(case(), {"samples": PAIRS, "tolerance_class": 3})
    assert relieved().names == drawn.names
    assert np.array_equal(relieved().deviation, drawn.deviation)


@pytest.mark.parametrize("side", ["before", "after"])
def test_as_designed_is_what_a_whole_analysis_of_the_scene_gives(side):
    """Bearing forces of the forced response with the table of the case lie within the stated error."""
    whole = scene()
    whole["meshes"][0]["case"] = RELIEVED if side == "after" else case()
    found = response(whole, {name: QUESTION[name] for name in ("speed_rpm", "orders")})
    square = 0.5 * np.sum(np.abs(found.bearing_force[:, :3]) ** 2, axis=(0, 1)).max(axis=0)
    levels = getattr(relieved(), side)
    level, (below, above) = levels.nominal[1, 1:], levels.error[:, 1, 1:]
    off, loud = 10.0 * np.log10(square) - level, level > level.max() - 25.0
    assert np.all((off >= -below) & (off <= above), where=loud), (off, below, above)
    assert np.max(np.abs(off[loud])) > 0.1  # by the stiffness that varies


def test_twice_the_transmission_error_is_6_db_louder(monkeypatch):
    """A spur pair whose stiffness is the same everywhere: its transmission error alone excites it."""
    involute = HeardFlanks.table

    def waved(self, pair, misalignment=0.0):
        plain = self.bodies.checked.request.pair
        twice = pair.pinion.modification.tip_relief > 0.0
        return rippling(involute(self, plain, misalignment), 2e-8 if twice else 1e-8)

    monkeypatch.setattr(HeardFlanks, "table", waved)
    louder = compared(None, RELIEVED, tolerances={"samples": 2})
    np.testing.assert_allclose(louder.nominal_change[:, :2], 20.0 * np.log10(2.0), atol=1e-3)
    np.testing.assert_allclose(louder.change[:, :, :2], 20.0 * np.log10(2.0), atol=1e-3)


def test_a_requirement_is_met_or_not():
    own = relieved()
    high = own.after.quantiles()[2, :, 0].max()
    met, missed = (compared(None, RELIEVED, requirement_db=float(high) + step) for step in (0.1, -0.1))
    assert (own.met, met.met, missed.met) == (None, True, False)
    assert ": met" in met.required() and "not met" in missed.required() and not own.required()


def helical(own: Json | None = None) -> Json:
    """The scene with a narrow helical pair in three dimensions."""
    found = small_inputs("modes")["scene"]
    found["meshes"][0]["case"] = own or helical_case()
    found["shafts"][1]["origin_mm"] = [21.3, 0.0, 0.0]
    found["loads"][0]["torque_n_m"] = [5.0]
    return found


def helical_case(**pinion: float) -> Json:
    gear = {"teeth": 20, "face_width_mm": 10.0, "bore_diameter_mm": 10.0}
    sizes = {"normal_module_mm": 1.0, "helix_angle_deg": 20.0, "center_distance_mm": 21.3}
    return {
        "pair": {**sizes, "pinion": gear | pinion, "wheel": gear},
        "load": {"torque_n_m": [2.5, 5.0]},
        "accuracy": {"level": "draft", "model": "3d", "positions": 64},
    }


def deviating(own: Json, names: tuple[str, ...], deviation: np.ndarray) -> Json:
    made = copy.deepcopy(own)
    for name, value in zip(names, deviation, strict=True):
        gear, quantity = name.split(".")
        field = f"{quantity}_um"
        made["pair"][gear][field] = made["pair"][gear].get(field, 0.0) + 1e6 * value
    return made


@pytest.mark.nightly
@pytest.mark.filterwarnings("ignore:.*smaller than can be made")
def test_quantiles_are_those_of_whole_analyses_of_the_pairs():
    """Of a helical pair in three dimensions, whose load travels along the face."""
    speeds: Json = {"speed_rpm": [1000.0, 3000.0, 6000.0], "orders": 3}
    designs = helical_case(), helical_case(tip_relief_um=4.0, tip_relief_length_mm=0.4, helix_crowning_um=3.0)
    tolerances = {"samples": 200, "tolerance_class": 4}
    own = change(helical(), {"after": designs[1], "tolerances": tolerances, **speeds})

    def level(case):
        force = response(helical(case), speeds).bearing_force[:, :3]
        return float(10.0 * np.log10(0.5 * np.sum(np.abs(force) ** 2, axis=(0, 1, 3)).max()))

    whole = np.array(
        [[level(deviating(design, own.names, each)) for each in own.deviation] for design in designs]
    )
    for levels, expected in (
        (own.before.pairs, whole[0]),
        (own.after.pairs, whole[1]),
        (own.change, whole[1] - whole[0]),
    ):
        fractions = 0.05, 0.5, 0.95
        np.testing.assert_allclose(
            np.quantile(levels[:, 0, 0], fractions), np.quantile(expected, fractions), atol=0.2
        )


@pytest.mark.nightly
def test_nine_of_ten_further_pairs_lie_in_the_band():
    """In the mean over samples of 200: one alone covers 2 % more or less."""
    question = {"load_cases": [{"name": "whole"}]}
    further = compared(
        None, RELIEVED, **question, tolerances={"samples": 1000, "tolerance_class": 3, "seed": 99}
    )
    samples = [
        compared(None, RELIEVED, **question, tolerances={"samples": 200, "tolerance_class": 3, "seed": seed})
        for seed in range(6)
    ]
    for levels in (lambda own: own.before.pairs, lambda own: own.after.pairs, lambda own: own.change):
        covered = []
        for own in samples:
            low, high = np.quantile(levels(own)[:, 0, 0], (0.05, 0.95))
            inside = levels(further)[:, 0, 0]
            covered.append(np.mean((inside >= low) & (inside <= high)))
        assert 0.87 <= np.mean(covered) <= 0.93


def test_a_scene_without_bearings_is_refused_before_it_is_solved():
    """Forces on bearings are what is heard; without one there is no level to compare."""
    bare = scene() | {"bushings": [], "rolling_bearings": [], "planet_bearings": []}
    with pytest.raises(BadInput, match=r"scene\.bushings = nothing: must be at least one bearing"):
        change(bare, {"after": RELIEVED, **QUESTION})
