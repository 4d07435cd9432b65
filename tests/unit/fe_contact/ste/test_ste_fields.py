"""What a database accepts, and what it says about itself."""

from __future__ import annotations

import math
from dataclasses import FrozenInstanceError, replace

import numpy as np
import pytest

from fe_contact.errors import DatabaseError
from fe_contact.ste import Metadata, PairFacts
from fe_contact.ste.fields import DIMENSIONS
from fe_contact.types import Status


def test_arrays_and_fields_cannot_be_changed(spur):
    for name in DIMENSIONS:
        with pytest.raises(ValueError, match="read-only"):
            getattr(spur, name)[...] = 0
    with pytest.raises(FrozenInstanceError):
        spur.force = np.ones(5)


def test_the_callers_arrays_stay_his_own(make):
    mine = np.full((64, 5, 1, 1), 1e-9)
    database = make(error_estimate=mine)
    mine[0] = 5.0
    assert database.error_estimate[0, 0, 0, 0] == 1e-9


def changed(name, place, value):
    """One array with one number changed."""

    def change(database):
        array = getattr(database, name).astype(float)
        array[place] = value
        return {name: array}

    return change


WRONG = [
    ("position", changed("position", -1, 1.0), r"lie in \[0, 1\)"),
    ("position", changed("position", 3, 0.01), "strictly increasing"),
    ("force", changed("force", 0, 0.0), "above 0 N"),
    ("force", changed("force", 1, np.nan), "non-empty and finite"),
    ("torque", changed("torque", 1, 7.0), r"equal F_bn cos\(beta_b\) r_b1"),
    ("pair", lambda _: {"pair": [-2, -1, 1, 2]}, "consecutive"),
    ("static_transmission_error", lambda _: {"misalignment": [0.0, 1e-6]}, "has shape .* needs"),
    ("status", lambda d: {"status": d.status[:, :, 0]}, r"needs \(64, 5, 1, 1\)"),
    ("residuals", lambda d: {"residuals": d.residuals[..., :3]}, r"needs \(64, 5, 1, 1, 4\)"),
    (
        "static_transmission_error",
        changed("static_transmission_error", (0, 0), np.nan),
        "finite exactly where",
    ),
    (
        "static_transmission_error",
        lambda d: {"static_transmission_error": d.static_transmission_error * 1e6},
        "in m",
    ),
    ("no_load_transmission_error", changed("no_load_transmission_error", 4, np.inf), "in m"),
    ("no_load_transmission_error", changed("no_load_transmission_error", 4, np.nan), "finite"),
    ("tangent_compliance", changed("tangent_compliance", (3, 2), 0.0), "above 0 m/N"),
    ("tangent_compliance", changed("tangent_compliance", (3, 2), np.inf), "finite"),
    ("load_share", changed("load_share", (3, 2, 0, 0, 1), -0.1), ">= 0"),
    ("load_share", lambda d: {"load_share": d.load_share * 0.99}, "sum to 1"),
    ("error_estimate", changed("error_estimate", (0, 0), -1e-9), ">= 0 m"),
    ("max_pressure", lambda _: {"max_pressure": "high"}, "no array of numbers"),
]


@pytest.mark.parametrize(("name", "change", "message"), WRONG)
def test_contradictions_are_refused_by_name(spur, name, change, message):
    with pytest.raises(DatabaseError, match=f"{name}.*{message}"):
        replace(spur, **change(spur))


def failed_at(database, *places):
    """The database with some points failed."""
    ste, status = database.static_transmission_error.copy(), database.status.copy()
    for place in places:
        ste[place], status[place] = np.nan, Status.ITERATION_LIMIT
    return replace(database, static_transmission_error=ste, status=status)


def test_a_converged_table_says_so(spur):
    assert spur.n_failed == 0
    assert "all points converged" in spur.summary()


def test_failed_points_are_loud(spur):
    database = failed_at(spur, (5, 1), (6, 2))
    assert database.n_failed == 2
    assert "WARNING: 2 of 320 points FAILED" in database.summary()
    assert "position 0.078125, force 1330 N" in database.summary()
    assert "ITERATION_LIMIT" in database.summary()


def test_many_failed_points_are_counted_not_listed(spur):
    message = failed_at(spur, slice(0, 4)).failure_message()
    assert "20 of 320" in message
    assert "and 15 more" in message


def test_identical_looks_at_every_bit(make, spur):
    assert spur.identical(make())
    ste = spur.static_transmission_error.copy()
    ste[3, 3] = np.nextafter(ste[3, 3], 1.0)
    assert not spur.identical(replace(spur, static_transmission_error=ste))
    assert not spur.identical(replace(spur, facts=replace(spur.facts, face_width=26e-3)))
    assert not spur.identical(replace(spur, metadata=replace(spur.metadata, content_hash="1")))


class TestFacts:
    def test_round_trip_through_json(self, helical_facts):
        assert PairFacts.from_json(helical_facts.to_json()) == helical_facts

    def test_normal_force_carries_the_torque_at_the_base_helix(self, helical_facts):
        expected = 100.0 / 60.3e-3 / math.cos(math.radians(24.0))
        assert helical_facts.normal_force(100.0) == pytest.approx(expected, rel=1e-15)

    @pytest.mark.parametrize(
        ("name", "value"),
        [
            ("base_pitch", 0.0),
            ("base_radius", (0.03, -1.0)),
            ("base_helix_angle", 1.6),
            ("helix_hand", 2),
            ("internal", 1),
            ("face_width", math.nan),
        ],
    )
    def test_nonsense_is_refused(self, helical_facts, name, value):
        with pytest.raises(DatabaseError, match=f"pair fact {name}"):
            replace(helical_facts, **{name: value})

    def test_missing_facts_are_refused(self, helical_facts):
        content = helical_facts.to_json()
        del content["base_pitch"]
        with pytest.raises(DatabaseError, match="base_pitch"):
            PairFacts.from_json(content)


class TestMetadata:
    def test_content_is_copied(self):
        case = {"pair": {"teeth": [20, 20]}}
        metadata = Metadata(case=case)
        case["pair"]["teeth"][0] = 7
        assert metadata.case == {"pair": {"teeth": [20, 20]}}

    @pytest.mark.parametrize("content", [{"x": math.nan}, {"x": {1, 2}}, {"x": np.float32(1.0)}])
    def test_only_plain_json(self, content):
        with pytest.raises(DatabaseError, match=r"metadata\.receipt is not plain JSON"):
            Metadata(receipt=content)
