"""What a plane leaves out of a finite width: its sign and size, and the figures that it corrects."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fe_contact import FlankModification, Gear, GearPair, SteDatabase, analyze
from fe_contact.ste.curve_errors import AT_NODES, PLANE

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
def cache(tmp_path_factory):
    return tmp_path_factory.mktemp("compliance")


@pytest.mark.drawn
@pytest.mark.law
@pytest.mark.parametrize("model", ["plane_strain", "plane_stress"])
@pytest.mark.parametrize(("teeth", "width"), [((20, 25), 3.0), ((23, 61), 6.0), ((40, 80), 18.0)])
def test_it_has_the_sign_and_size_of_the_correction_by_finite_elements(teeth, width, model, cache):
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
            stated = getattr(plain.curve(force=force).over_face, name)
            assert abs(other.value - stated.value) <= allowed * stated.error + other.error
            assert stated.error < 2.0 * (one.error + error * one.value)  # no band of the whole bias


def test_where_relief_hides_the_ripple_it_may_have_either_sign(cache):
    pair = pair_of(21, 31, 5.0, RELIEVED)
    plain, corrected = (table(pair, cache, **how) for how in ({"model": "plane_strain"}, {}))
    bias = plain.metadata.receipt["bias"]
    change = [
        corrected.peak_to_peak(force=force).value - plain.peak_to_peak(force=force).value
        for force in plain.force
    ]
    assert bias["peak_to_peak"] is None and "either way" in bias["words"]
    assert 0.0 < max(np.abs(change)) <= bias["either_way_m"]


def test_no_error_of_a_plane_holds_what_it_leaves_out(cache):
    """Curves and bands err by as much as those of the corrected plane, on the same mesh."""
    plain, reference = (
        table(pair_of(20, 25, 6.0, RELIEVED), cache, **how) for how in ({"model": "plane_strain"}, {})
    )
    assert not plain.curve_error[AT_NODES.index(PLANE)].any()
    ratio = plain.error_estimate.mean(axis=0) / reference.error_estimate.mean(axis=0)
    assert np.all((ratio > 0.7) & (ratio < 1.1))
    for force in plain.force:
        one, other = plain.curve(force=force), reference.curve(force=force)
        assert 0.7 < one.mean.error / other.mean.error < 1.1
        assert one.over_face is not None and other.over_face is None
        assert one.over_face.mean.error > one.mean.error


# Mean in three dimensions over plane strain by resolved contact, of pairs of module 4 mm: the ratio is held
# against pairs of the same teeth and face in modules, of module 2 mm, at the loads of this file.
RESOLVED = {"20/20": (20, 20, 6.25, (1.028, 1.030)), "40/80": (40, 80, 20.0, (1.018, 1.025))}


@pytest.mark.law
@pytest.mark.parametrize("name", RESOLVED)
def test_the_mean_over_the_face_covers_resolved_contact_without_a_band_of_the_bias(name, cache):
    first, second, width, (minimum, maximum) = RESOLVED[name]
    plain = table(pair_of(first, second, width, FlankModification()), cache, model="plane_strain")
    for force in plain.force:
        curve = plain.curve(force=force)
        mean, stated = curve.mean.value, curve.over_face.mean
        assert stated.value - stated.error <= minimum * mean and maximum * mean <= stated.value + stated.error
        assert stated.error < 0.008 * mean


def test_an_older_file_loses_the_bias_from_its_errors(cache, tmp_path):
    """Files of schema 4 held 1.25 times the bias in bands and curve errors."""
    plain = table(pair_of(20, 25, 6.0, FlankModification()), cache, model="plane_strain")
    part, errors = 1.25 * plain.metadata.receipt["bias"]["mean"], plain.curve_error.copy()
    errors[AT_NODES.index(PLANE)] = part * plain.static_transmission_error.max()
    old = {
        "mean": 0.03,
        "peak_to_peak": 0.03,
        "either_way_m": 0.0,
        "error": 0.2,
        "stated": part,
        "words": "bias",
    }
    receipt = plain.metadata.receipt | {"bias": old}
    replace(
        plain,
        error_estimate=plain.error_estimate + part * np.abs(plain.static_transmission_error),
        curve_error=errors,
        metadata=replace(plain.metadata, receipt=receipt),
    ).to_netcdf(tmp_path / "old.nc")
    read = SteDatabase.from_netcdf(tmp_path / "old.nc")
    assert np.allclose(read.error_estimate, plain.error_estimate, rtol=1e-9, atol=0.0)
    assert np.array_equal(read.curve_error, plain.curve_error)
    assert read.curve(force=plain.force[0]).over_face is None


def test_a_corrected_plane_and_three_dimensions_have_none(cache):
    for how in ({}, {"model": "3d", "positions": 8}):
        found = table(pair_of(20, 25, 6.0, FlankModification()), cache, **how)
        assert "bias" not in found.metadata.receipt
        assert found.curve(force=found.force[0]).over_face is None
