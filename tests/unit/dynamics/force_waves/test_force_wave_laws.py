"""Force waves: patterns are orthogonal, resultants those of a quadrature, tables interpolate in bounds."""

from dataclasses import FrozenInstanceError, replace

import numpy as np
import pytest

from dynamics.errors import InputError
from dynamics.force_waves import AirGap, ForceWaves, ForceWaveTable, resultants

GAP = AirGap(radius=0.08, length=0.15)
ORDERS = [(0, 0), (0, 1), (0, 8), (1, 1), (1, -1), (8, 0), (8, 2), (48, 0), (48, 1), (48, -1), (48, -8)]
ANGLE = 2.0 * np.pi * np.arange(64) / 64
SPEED = 300.0


def waves(seed=1, orders=ORDERS, speed=SPEED):
    draw = np.random.default_rng(seed)
    radial, tangential = 1e4 * (draw.normal(size=(2, len(orders))) + 1j * draw.normal(size=(2, len(orders))))
    temporal, spatial = np.array(orders).T
    return ForceWaves(temporal, spatial, radial, tangential, speed, 100.0)


def single(order, radial=0.0, tangential=0.0):
    temporal, spatial = np.array([order]).T
    return ForceWaves(temporal, spatial, np.array([radial]), np.array([tangential]), SPEED, 100.0)


def quadrature(field, time):
    """Return torque, F_x and F_y on the rotor at a time, from the pressures at points of the bore."""
    radial, tangential = field.pressure(ANGLE, time)
    area = GAP.radius * GAP.length * 2.0 * np.pi
    along_x = radial * np.cos(ANGLE) - tangential * np.sin(ANGLE)
    along_y = radial * np.sin(ANGLE) + tangential * np.cos(ANGLE)
    return area * np.array([GAP.radius * tangential.mean(), along_x.mean(), along_y.mean()])


def history(field, time):
    """Return torque, F_x and F_y at a time from the amplitudes of the resultants."""
    found = resultants(field, GAP)
    turn = np.exp(1j * found.temporal_order * field.speed * time)
    return np.array([np.sum((found.torque * turn).real), *np.sum((found.pull.T * turn).real, axis=1)])


@pytest.mark.parametrize("component", ["radial", "tangential"])
def test_patterns_are_orthogonal_over_bore_and_revolution(component):
    times = 2.0 * np.pi / SPEED * np.arange(128) / 128
    patterns = []
    for order in ORDERS:
        wave = single(order, **{component: 1.0})
        index = ["radial", "tangential"].index(component)
        patterns.append(np.array([wave.pressure(ANGLE, time)[index] for time in times]).ravel())
    gram = np.array(patterns) @ np.array(patterns).T / patterns[0].size
    assert np.abs(gram - np.diag(np.diag(gram))).max() < 1e-9
    expected = [1.0 if order == (0, 0) else 0.5 for order in ORDERS]
    np.testing.assert_allclose(np.diag(gram), expected, atol=1e-9)


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("pressures", [(3e4 * np.exp(0.7j), 0.0), (0.0, 2e4 * np.exp(-1.9j))])
def test_resultants_of_each_wave_are_those_of_a_quadrature(order, pressures):
    wave = single(order, *pressures)
    for time in (0.0, 1.3e-3, 7.7e-3):
        np.testing.assert_allclose(history(wave, time), quadrature(wave, time), rtol=1e-12, atol=1e-9)


def test_resultants_of_all_waves_are_those_of_a_quadrature():
    for time in (0.0, 2.1e-3, 1.9e-2):
        np.testing.assert_allclose(history(waves(), time), quadrature(waves(), time), rtol=1e-11)


def test_the_torque_of_a_pulsation_is_pressure_times_radius_times_area():
    found = resultants(single((48, 0), tangential=1e3), GAP)
    assert found.torque[0] == pytest.approx(1e3 * GAP.radius * 2.0 * np.pi * GAP.radius * GAP.length)
    assert resultants(single((48, 0), radial=1e3), GAP).torque[0] == 0.0


@pytest.mark.parametrize("order", [(8, 2), (48, -8), (0, 8)])
def test_waves_of_two_and_more_periods_have_no_resultant(order):
    found = resultants(single(order, 1e5, 1e5), GAP)
    assert not np.any(found.torque) and not np.any(found.pull) and not np.any(found.largest_pull)


@pytest.mark.parametrize("field", [waves(3), waves(4)])
def test_the_largest_pull_is_the_largest_over_a_period(field):
    found = resultants(field, GAP)
    turn = np.exp(2j * np.pi * np.arange(20_000) / 20_000)
    for k, pull, largest in zip(found.temporal_order, found.pull, found.largest_pull, strict=True):
        turned = turn if k else np.ones(1)
        size = np.linalg.norm(np.real(np.multiply.outer(turned, pull)), axis=1)
        assert size.max() == pytest.approx(largest, rel=1e-6)


def test_resultants_are_linear():
    one, other = waves(5), waves(6)
    both = replace(
        one, radial=2.0 * one.radial - other.radial, tangential=2.0 * one.tangential - other.tangential
    )
    first, second, total = (resultants(field, GAP) for field in (one, other, both))
    for name in ("torque", "pull"):
        expected = 2.0 * getattr(first, name) - getattr(second, name)
        np.testing.assert_allclose(getattr(total, name), expected, rtol=1e-12, atol=1e-9)


def test_a_turn_of_the_frame_shifts_phases_and_turns_the_pull_alone():
    turn = 0.83
    field = waves(7)
    turned = field.rotated(turn)
    for here, there in zip(field.pressure(ANGLE + turn, 3e-3), turned.pressure(ANGLE, 3e-3), strict=True):
        np.testing.assert_allclose(here, there, rtol=1e-10, atol=1e-6)
    shift = np.angle(turned.radial / field.radial) - turn * field.spatial_order
    np.testing.assert_allclose(np.exp(1j * shift), 1.0, atol=1e-12)
    torque, along_x, along_y = history(field, 3e-3)
    expected = [
        torque,
        along_x * np.cos(turn) + along_y * np.sin(turn),
        along_y * np.cos(turn) - along_x * np.sin(turn),
    ]
    np.testing.assert_allclose(history(turned, 3e-3), expected, rtol=1e-10)


def test_a_wave_travels_with_the_rotor_by_its_spatial_order():
    """The crest of order (k, r) turns at k Omega / r, against the rotor if r < 0."""
    for order in ((8, 2), (48, -8)):
        time = 1e-3
        moved = order[0] * SPEED * time / order[1]
        wave = single(order, 1e4)
        np.testing.assert_allclose(
            wave.pressure(ANGLE + moved, time)[0], wave.pressure(ANGLE, 0.0)[0], atol=1e-7
        )
        assert wave.frequency[0] == pytest.approx(order[0] * SPEED / (2.0 * np.pi))


def table():
    draw = np.random.default_rng(9)
    temporal, spatial = np.array(ORDERS).T
    speed, torque = np.array([100.0, 200.0, 500.0]), np.array([-50.0, 0.0, 80.0])
    radial, tangential = draw.normal(size=(2, len(ORDERS), 3, 3)) + 1j * draw.normal(
        size=(2, len(ORDERS), 3, 3)
    )
    return ForceWaveTable(temporal, spatial, speed, torque, radial, tangential)


def test_a_table_returns_its_nodes_and_is_bilinear_between_them():
    of_machine = table()
    np.testing.assert_array_equal(of_machine.at(500.0, 0.0).radial, of_machine.radial[:, 2, 1])
    corners = of_machine.tangential[:, 1:3, 0:2]
    expected = np.einsum("wsm,s,m->w", corners, [0.75, 0.25], [0.4, 0.6])
    np.testing.assert_allclose(of_machine.at(275.0, -20.0).tangential, expected, rtol=1e-12)


@pytest.mark.parametrize(
    ("point", "field"),
    [
        ((99.0, 0.0), "speed"),
        ((501.0, 0.0), "speed"),
        ((200.0, -51.0), "torque"),
        ((200.0, np.nan), "torque"),
    ],
)
def test_a_point_outside_the_table_is_refused_with_its_bound(point, field):
    with pytest.raises(InputError) as caught:
        table().at(*point)
    assert caught.value.field == field
    if np.isfinite(point).all():
        assert "from" in str(caught.value) and "not extended" in str(caught.value)


def test_a_table_is_frozen_and_a_copy():
    of_machine = table()
    with pytest.raises(FrozenInstanceError):
        of_machine.speed = np.ones(3)
    for name in ("temporal_order", "speed", "radial", "tangential"):
        with pytest.raises(ValueError, match="read-only"):
            getattr(of_machine, name)[0] = 1.0


def test_a_table_comes_back_from_its_file(tmp_path):
    of_machine = table()
    of_machine.to_netcdf(tmp_path / "machine.nc")
    back = ForceWaveTable.from_netcdf(tmp_path / "machine.nc")
    for name in ForceWaveTable.arrays():
        np.testing.assert_array_equal(getattr(back, name), getattr(of_machine, name))


@pytest.mark.parametrize(
    ("change", "field"),
    [
        ({"temporal_order": np.array([-1, *[k for k, _ in ORDERS[1:]]])}, "temporal_order[0]"),
        ({"temporal_order": np.array([0.5, *[float(k) for k, _ in ORDERS[1:]]])}, "temporal_order[0]"),
        ({"spatial_order": np.array([r for _, r in ORDERS[:-1]])}, "spatial_order"),
        ({"spatial_order": np.array([0, -1, *[r for _, r in ORDERS[2:]]])}, "spatial_order[1]"),
        ({"spatial_order": np.array([0, 0, *[r for _, r in ORDERS[2:]]])}, "spatial_order[1]"),
        ({"speed": np.array([-1.0, 0.0, 1.0])}, "speed[0]"),
        ({"speed": np.array([1.0, 1.0, 2.0])}, "speed"),
        ({"torque": np.array([1.0, np.nan, 2.0])}, "torque"),
        ({"radial": np.zeros((2, 3, 3))}, "radial"),
        ({"tangential": np.full((len(ORDERS), 3, 3), np.inf)}, "tangential"),
    ],
)
def test_a_table_that_cannot_be_is_refused_by_its_field(change, field):
    with pytest.raises(InputError) as caught:
        replace(table(), **change)
    assert caught.value.field == field


@pytest.mark.parametrize("size", [{"radius": 0.0}, {"length": -1.0}, {"radius": np.nan}, {"length": np.inf}])
def test_an_air_gap_without_a_size_is_refused(size):
    with pytest.raises(InputError, match=next(iter(size))):
        replace(GAP, **size)


def test_what_stands_still_has_no_quadrature():
    found = resultants(waves(8), GAP)
    assert found.temporal_order[0] == 0
    assert found.torque[0].imag == 0.0 and not np.any(found.pull[0].imag)
