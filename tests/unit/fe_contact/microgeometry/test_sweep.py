"""Sweeps: every point is the pair analyzed alone, in any order of the axes, whoever does the work."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fe_contact import GearPair, analyze
from fe_contact.errors import InputError
from fe_contact.microgeometry.sweep import Sweep, SweepAxis, SweepRequest, sweep
from fe_contact.microgeometry.variables import modified
from fe_contact.options import AnalysisOptions, OperatingPoint, Run
from fe_contact.workers import Remembering, RunCost

DRAFT: dict[str, Any] = {"level": "draft", "model": "plane_strain"}
TORQUES, RELIEFS = (60.0, 120.0, 200.0), (0.0, 10e-6, 30e-6)
AXES = (SweepAxis("torque", TORQUES), SweepAxis("tip_relief", RELIEFS))


def request(pair: GearPair, axes: tuple[SweepAxis, ...] = AXES, **options: Any) -> SweepRequest:
    return SweepRequest(pair, axes, OperatingPoint(torque=200.0), AnalysisOptions(**{**DRAFT, **options}))


@pytest.fixture(scope="module")
def swept(long_reliefs: GearPair, compliances: Path) -> Sweep:
    return sweep(request(long_reliefs), Run(cache=compliances))


def by_name(result: Sweep, name: str) -> Any:
    return next(quantity for quantity in result.quantities if quantity.name == name)


def test_every_point_is_the_pair_analyzed_alone(
    swept: Sweep, long_reliefs: GearPair, compliances: Path
) -> None:
    ripple = by_name(swept, "peak_to_peak")
    for k in (1, 5, 6):
        torque, relief = swept.point[k]
        flanks = {"pinion.tip_relief": relief, "wheel.tip_relief": relief}
        table = analyze(
            modified(long_reliefs, flanks),
            torques=[torque, 210.0],
            positions=192,
            cache=compliances,
            effects={"corner_contact": "on"},
            **DRAFT,
        )
        alone = table.peak_to_peak(torque=torque)
        assert abs(ripple.value[k] - alone.value) < 0.1 * (ripple.error[k] + alone.error)
        assert by_name(swept, "harmonic_1").value[k] == pytest.approx(
            table.harmonics(torque=torque)[0].value, rel=0.02
        )
        largest = np.nanmax(table.max_pressure[:, 0])
        assert by_name(swept, "max_pressure").value[k] == pytest.approx(largest, rel=0.02)


def test_the_errors_cover_a_finer_mesh(swept: Sweep, long_reliefs: GearPair, compliances: Path) -> None:
    fine = sweep(request(long_reliefs, level="standard"), Run(cache=compliances))
    for name in ("peak_to_peak", "harmonic_1", "max_pressure"):
        here, there = by_name(swept, name), by_name(fine, name)
        rounding = 8.0 * np.spacing(np.abs(here.value))  # where one pair carries all, meshes agree but for it
        assert np.all(np.abs(here.value - there.value) <= here.error + there.error + rounding), name
        assert np.all(here.error < 0.5 * here.value.max()), "an error that says something"


def test_the_order_of_the_axes_does_not_matter(
    swept: Sweep, long_reliefs: GearPair, compliances: Path
) -> None:
    other = sweep(request(long_reliefs, AXES[::-1]), Run(cache=compliances))
    np.testing.assert_array_equal(
        other.point[:, ::-1].reshape(3, 3, 2).swapaxes(0, 1), swept.point.reshape(3, 3, 2)
    )
    for quantity in swept.quantities:
        turned = by_name(other, quantity.name).value.reshape(3, 3).T.ravel()
        np.testing.assert_array_equal(turned, quantity.value)


def test_a_gear_alone_is_not_both(swept: Sweep, long_reliefs: GearPair, compliances: Path) -> None:
    alone = sweep(
        request(long_reliefs, (AXES[0], SweepAxis("pinion.tip_relief", RELIEFS))), Run(cache=compliances)
    )
    both, one = (by_name(each, "peak_to_peak").value.reshape(3, 3) for each in (swept, alone))
    np.testing.assert_array_equal(both[:, 0], one[:, 0])  # without relief they are alike
    assert np.all(np.abs(both[:, 1:] - one[:, 1:]) > 1e-9)


def test_the_plane_has_no_face_load_factor(swept: Sweep) -> None:
    assert "face_load_factor" not in {quantity.name for quantity in swept.quantities}


def test_a_misaligned_pair_is_computed_over_the_face(pair: GearPair, compliances: Path) -> None:
    narrow = replace(
        pair, pinion=replace(pair.pinion, face_width=8e-3), wheel=replace(pair.wheel, face_width=8e-3)
    )
    axis = SweepAxis("misalignment", (-20e-6, 0.0, 20e-6))
    found = sweep(request(narrow, (axis,), model="auto"), Run(cache=compliances))
    factor = by_name(found, "face_load_factor")
    assert factor.value[0] == pytest.approx(factor.value[2], rel=1e-3)  # a spur pair has no hand
    assert factor.value[1] < factor.value[0] - factor.error[0]
    assert found.held == {"torque": 200.0, "center_distance_change": 0.0}


@pytest.mark.parametrize(
    ("axes", "name"),
    [
        ((), "one or two"),
        ((AXES[0], AXES[0]), "one axis"),
        ((AXES[1], SweepAxis("wheel.tip_relief", RELIEFS)), "one axis"),
        ((SweepAxis("torque", (100.0,)),), "at least two"),
        ((SweepAxis("helix_angle", (0.1, 0.2)),), "tip_relief"),
        ((SweepAxis("torque", tuple(np.linspace(10.0, 20.0, 5000))),), "4096"),
    ],
)
def test_what_makes_no_map_is_refused(pair: GearPair, axes: tuple[SweepAxis, ...], name: str) -> None:
    with pytest.raises(InputError, match=name):
        _ = request(pair, axes).checked


def test_a_relief_without_a_length_is_refused(pair: GearPair) -> None:
    with pytest.raises(InputError, match="tip_relief_length"):
        _ = request(pair).checked


@dataclass(frozen=True)
class Breaking:
    """Workers that are interrupted after some tasks."""

    after: int
    done: list[int] = field(default_factory=list)

    @property
    def cost(self) -> RunCost:
        return RunCost()

    def run(self, function: Callable[..., Any], shared: Any, items: Sequence[Any]) -> Iterator[Any]:
        for item in items:
            if len(self.done) == self.after:
                raise KeyboardInterrupt
            self.done.append(1)
            yield function(shared, item)


def test_an_interrupted_sweep_goes_on_where_it_was(
    swept: Sweep, long_reliefs: GearPair, compliances: Path, tmp_path: Path
) -> None:
    first, second = Breaking(2), Breaking(9)
    with pytest.raises(KeyboardInterrupt):
        sweep(request(long_reliefs), Run(Remembering(first, tmp_path, "1"), compliances))
    resumed = sweep(request(long_reliefs), Run(Remembering(second, tmp_path, "1"), compliances))
    assert len(second.done) == len(RELIEFS) - 2
    for quantity in swept.quantities:
        np.testing.assert_array_equal(by_name(resumed, quantity.name).value, quantity.value)
