"""What a plane leaves out of a finite width: its sign and size, its errors, and a table without it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from fe_contact import FlankModification, Gear, GearPair, SteDatabase, analyze
from fe_contact.ste import in_own_model
from fe_contact.ste.curve import AT_NODES, PLANE

FORCES = [400.0, 1000.0]
RELIEVED = FlankModification(tip_relief=10e-6, tip_relief_length=0.9e-3)


def pair_of(first: int, second: int, width: float, modification: FlankModification) -> GearPair:
    """Return a pair of module 2 mm with a face of `width` modules."""
    gears = (Gear(z, 2e-3, width * 2e-3, z * 1e-3, modification=modification) for z in (first, second))
    return GearPair(*gears, (first + second) * 1e-3)


def table(pair: GearPair, cache: Path, **how: object) -> SteDatabase:
    forces = [force * pair.face_width / 12e-3 for force in FORCES]
    return analyze(pair, normal_forces=forces, level="draft", cache=cache, **how)


@pytest.fixture(scope="module")
def cache(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("compliance")


@pytest.mark.drawn
@pytest.mark.law
@pytest.mark.parametrize("model", ["plane_strain", "plane_stress"])
@pytest.mark.parametrize(("teeth", "width"), [((20, 25), 3.0), ((23, 61), 6.0), ((40, 80), 18.0)])
def test_it_has_the_sign_and_size_of_the_correction_by_finite_elements(
    teeth: tuple[int, int], width: float, model: str, cache: Path
) -> None:
    pair = pair_of(*teeth, width, FlankModification())
    plain = table(pair, cache, model=model)
    corrected = table(pair, cache, effects={"finite_width": "on"})
    bias = plain.metadata.receipt["bias"]
    assert bias["either_way_m"] == 0.0 and np.sign(bias["mean"]) == (1.0 if model == "plane_strain" else -1.0)
    for force in plain.force:
        for name, allowed in (("mean", 1.0), ("peak_to_peak", 1.5)):
            one, other = (getattr(found, name)(force=force) for found in (plain, corrected))
            true, error = other.value / one.value - 1.0, bias["error"] * abs(bias[name])
            assert true == pytest.approx(bias[name], rel=0.0, abs=allowed * error), name
            assert abs(other.value - one.value) <= one.error  # which is complete


def test_where_relief_hides_the_ripple_it_may_have_either_sign(cache: Path) -> None:
    pair = pair_of(21, 31, 5.0, RELIEVED)
    plain, corrected = (table(pair, cache, **how) for how in ({"model": "plane_strain"}, {}))
    bias = plain.metadata.receipt["bias"]
    change = [
        corrected.peak_to_peak(force=force).value - plain.peak_to_peak(force=force).value
        for force in plain.force
    ]
    assert bias["peak_to_peak"] is None and "either way" in bias["words"]
    assert 0.0 < max(np.abs(change)) <= bias["either_way_m"]


def test_a_table_towards_its_own_model_lacks_it_and_nothing_else(cache: Path) -> None:
    plain = table(pair_of(20, 25, 6.0, RELIEVED), cache, model="plane_strain")
    own, row = in_own_model(plain), AT_NODES.index(PLANE)
    for force in plain.force:
        whole, left = plain.mean(force=force), own.mean(force=force)
        (k,) = np.flatnonzero(plain.force == force)
        assert left.value == whole.value
        part = plain.curve_error[row, 0, k, 0, 0]
        assert np.hypot(left.error, part) == pytest.approx(whole.error, rel=1e-9)
        assert left.error < 0.2 * whole.error
    ste = plain.static_transmission_error
    reference = in_own_model(table(pair_of(20, 25, 6.0, RELIEVED), cache)).error_estimate
    assert np.all(own.error_estimate >= 0.0) and np.max(own.error_estimate / ste) < 0.3 * np.max(
        plain.error_estimate / ste
    )
    assert np.max(own.error_estimate) < 2.0 * np.max(reference)


def test_a_corrected_plane_and_three_dimensions_have_none(cache: Path) -> None:
    for how in ({}, {"model": "3d", "positions": 8}):
        found = table(pair_of(20, 25, 6.0, FlankModification()), cache, **how)
        assert "bias" not in found.metadata.receipt
        assert in_own_model(found) is found
