"""What a database accepts and says of itself, its repair, its error against another, its content hash."""

import hashlib
import math
from dataclasses import FrozenInstanceError, replace

import numpy as np
import pytest
from held_out import held_out_error

from fe_contact.errors import DatabaseError, InputError, SolveError
from fe_contact.ste import Metadata, PairGeometry
from fe_contact.ste.fields import DIMENSIONS
from fe_contact.ste.metadata import content_hash
from fe_contact.ste.table_repair import without_failed_rows
from fe_contact.types import Status


def test_arrays_and_fields_cannot_be_changed(spur, make):
    for name in DIMENSIONS:
        with pytest.raises(ValueError, match="read-only"):
            getattr(spur, name)[...] = 0
    with pytest.raises(FrozenInstanceError):
        spur.force = np.ones(5)
    mine = np.full((64, 5, 1, 1), 1e-9)
    database = make(error_estimate=mine)
    mine[0] = 5.0
    assert database.error_estimate[0, 0, 0, 0] == 1e-9


def changed(name, place, value):
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


def test_a_table_says_which_points_failed(spur):
    assert spur.n_failed == 0
    assert "all points converged" in spur.summary()
    database = failed_at(spur, (5, 1), (6, 2))
    assert database.n_failed == 2
    assert "WARNING: 2 of 320 points FAILED" in database.summary()
    assert "position 0.078125, force 1330 N" in database.summary()
    assert "ITERATION_LIMIT" in database.summary()
    message = failed_at(spur, slice(0, 4)).failure_message()
    assert "20 of 320" in message
    assert "and 15 more" in message


def test_identical_looks_at_every_bit(make, spur):
    assert spur.identical(make())
    ste = spur.static_transmission_error.copy()
    ste[3, 3] = np.nextafter(ste[3, 3], 1.0)
    assert not spur.identical(replace(spur, static_transmission_error=ste))
    assert not spur.identical(replace(spur, geometry=replace(spur.geometry, face_width=26e-3)))
    assert not spur.identical(replace(spur, metadata=replace(spur.metadata, content_hash="1")))


def test_facts_come_back_from_json_and_carry_the_torque(helical_facts):
    assert PairGeometry.from_json(helical_facts.to_json()) == helical_facts
    expected = 100.0 / 60.3e-3 / math.cos(math.radians(24.0))
    assert helical_facts.normal_force(100.0) == pytest.approx(expected, rel=1e-15)
    content = helical_facts.to_json()
    del content["base_pitch"]
    with pytest.raises(DatabaseError, match="base_pitch"):
        PairGeometry.from_json(content)

    wrong = {"base_pitch": 0.0, "base_radius": (0.03, -1.0), "base_helix_angle": 1.6}
    for name, value in {**wrong, "helix_hand": 2, "internal": 1, "face_width": math.nan}.items():
        with pytest.raises(DatabaseError, match=f"pair fact {name}"):
            replace(helical_facts, **{name: value})


def test_content_is_copied_and_plain_json():
    case = {"pair": {"teeth": [20, 20]}}
    metadata = Metadata(case=case)
    case["pair"]["teeth"][0] = 7
    assert metadata.case == {"pair": {"teeth": [20, 20]}}
    for value in (math.nan, {1, 2}, np.float32(1.0)):
        with pytest.raises(DatabaseError, match=r"metadata\.receipt is not plain JSON"):
            Metadata(receipt={"x": value})


def test_failed_points_go_as_whole_rows(spur, four_axes):
    assert without_failed_rows(spur) is spur
    rest = without_failed_rows(failed_at(spur, np.s_[:, 4]))
    assert rest.force.tolist() == spur.force[:4].tolist()
    assert rest.position.size == 64
    rest = without_failed_rows(failed_at(spur, (3, 0), (17, 4)))
    assert rest.position.tolist() == np.delete(spur.position, [3, 17]).tolist()
    assert rest.force.size == 5
    rest = without_failed_rows(failed_at(four_axes, np.s_[:, :, 3]))
    assert rest.misalignment.tolist() == four_axes.misalignment[:3].tolist()
    assert np.array_equal(rest.load_share, four_axes.load_share[:, :, :3])
    assert np.array_equal(rest.no_load_transmission_error, four_axes.no_load_transmission_error[:, :3])
    with pytest.raises(SolveError, match="No complete row remains"):
        without_failed_rows(failed_at(spur, np.s_[:]))


def noisy(make, size, seed=2):
    """A table with closely spaced loads and noise of `size` meters."""
    database = make(force=2660.0 * (1.0 + 0.01 * np.arange(8)))
    noise = np.random.default_rng(seed).normal(scale=size, size=(64, 8, 1, 1))
    return replace(database, static_transmission_error=database.static_transmission_error + noise)


def test_noise_is_refused_and_repaired_on_request(make):
    database = noisy(make, 5e-8)
    with pytest.raises(DatabaseError, match="monotone_repaired"):
        database.force_table()
    repaired, report = database.monotone_repaired()
    assert np.all(np.diff(repaired.force_table().deflection, axis=-1) > 0.0)
    assert report.curves > 30
    change = np.abs(repaired.static_transmission_error - database.static_transmission_error)
    i, k = np.searchsorted(database.position, report.position), np.searchsorted(database.force, report.force)
    assert report.largest_change == pytest.approx(change.max(), rel=1e-9)
    assert change[i, k, 0, 0] == change.max()
    assert repaired.metadata.receipt["monotone_repair"]["largest_change"] == report.largest_change
    assert repaired.error_estimate == pytest.approx(database.error_estimate + change, rel=1e-9)
    truth = make(force=2660.0 * (1.0 + 0.01 * np.arange(8))).static_transmission_error
    before = np.sqrt(np.mean((database.static_transmission_error - truth) ** 2))
    assert np.sqrt(np.mean((repaired.static_transmission_error - truth) ** 2)) < before


def test_lift_off_is_not_moved_nor_series_in_order(make, spur):
    """The no-load transmission error is geometry; a first load below it is what has to yield."""
    database = make()
    ste = database.static_transmission_error.copy()
    ste[7, 0] = -1e-7
    repaired, report = replace(database, static_transmission_error=ste).monotone_repaired()
    assert report.curves == 1
    moved = repaired.no_load_transmission_error - database.no_load_transmission_error
    assert np.abs(moved).max() < 1e-12
    assert repaired.static_transmission_error[7, 0, 0, 0] > 0.0
    repaired, report = database.monotone_repaired()
    assert report.curves == 0
    assert report.largest_change == 0.0
    assert np.array_equal(repaired.static_transmission_error, database.static_transmission_error)
    with pytest.raises(SolveError, match="1 of 320"):
        failed_at(spur, (1, 1)).monotone_repaired()


def test_a_known_difference_is_found_where_it_is(spur, make):
    result = held_out_error(spur, spur)
    assert result.maximum == 0.0
    assert result.relative_rms == 0.0
    other = make(position=spur.position[::4], force=spur.force[1:4])
    shifted = other.static_transmission_error.copy()
    shifted[5, 2] += 1e-8
    result = held_out_error(spur, replace(other, static_transmission_error=shifted))
    assert result.maximum == pytest.approx(1e-8, rel=1e-6)
    assert (result.position, result.force) == (other.position[5], other.force[2])
    assert result.rms == pytest.approx(1e-8 / np.sqrt(16 * 3), rel=1e-6)
    swing = np.ptp(shifted[:, 2])
    assert result.relative_maximum == pytest.approx(1e-8 / swing, rel=1e-6)
    assert result.relative_rms == pytest.approx(1e-8 / 4 / swing, rel=1e-6)


def test_position_error_falls_with_the_spacing(make):
    """At the stored loads; the curves have kinks, so the largest error falls with the first power."""
    force = [500.0, 2000.0, 8000.0]
    truth = make(position=(np.arange(97) + 0.31) / 97, force=force)
    results = [held_out_error(make(position=np.arange(n) / n, force=force), truth) for n in (64, 256, 1024)]
    assert results[1].maximum < 0.35 * results[0].maximum
    assert results[2].maximum < 0.35 * results[1].maximum
    assert results[2].relative_rms < 0.05 * results[0].relative_rms


def test_load_error_alone_falls_fast(make):
    """At the stored positions only the load direction is interpolated."""
    truth = make(force=[500.0, 2000.0, 8000.0])
    coarse = held_out_error(make(force=np.geomspace(266.0, 10640.0, 6)), truth)
    fine = held_out_error(make(force=np.geomspace(266.0, 10640.0, 24)), truth)
    assert fine.maximum < 0.2 * coarse.maximum


def test_points_outside_or_failed_are_refused(make, spur):
    with pytest.raises(InputError, match=r"other\.force.*from 266 to 10640"):
        held_out_error(spur, make(force=[100.0]))
    with pytest.raises(InputError, match="two or more positions"):
        held_out_error(spur, make(position=[0.5]))
    with pytest.raises(SolveError, match="1 of 320"):
        held_out_error(spur, failed_at(spur, (0, 0)))


def test_the_content_hash_is_sha256_of_the_canonical_text():
    """RFC 8785: keys sorted, no white space, numbers as ECMAScript writes them."""
    text = '{"case":{"a":[56,0.00001,1e+30],"b":"\\u20ac"},"schema_version":1,"solver_version":"0.1.0"}'
    case = {"b": "\u20ac", "a": [56.0, 1e-5, 1e30]}
    assert (
        content_hash(case, "0.1.0", 1)
        == hashlib.sha256(text.replace("\\u20ac", "\u20ac").encode()).hexdigest()
    )
    one = content_hash({"teeth": 20, "load": {"torque": 100, "kind": "x"}}, "0.1.0", 1)
    assert one == content_hash({"load": {"kind": "x", "torque": 1e2}, "teeth": 20.0}, "0.1.0", 1)
    assert content_hash({"x": 0.1}, "", 1) != content_hash({"x": math.nextafter(0.1, 1.0)}, "", 1)

    asked = ({"teeth": 20}, "0.1.0", 1), ({"teeth": 21}, "0.1.0", 1), ({"teeth": 20}, "0.1.1", 1)
    assert len({content_hash(*each) for each in (*asked, ({"teeth": 20}, "0.1.0", 2), ({}, "0.1.0", 1))}) == 5
    for value in (math.nan, math.inf, np.array([1.0]), {1}, 2**60, object()):
        with pytest.raises(InputError, match="case = 'dict': must be plain JSON"):
            content_hash({"x": value}, "0.1.0", 1)
