"""The condensed peer against resolved full contact of two independent codes, and against its own meshes."""

import csv
from pathlib import Path

import numpy as np
import pytest
from spur_gears import PAIR

from verification.full_contact import Resolution, solve_full_contact
from verification.full_contact.condensation import gear_boundary

REFERENCE = Path(__file__).parents[2] / "reference" / "spur_20_20_full_contact.csv"
SOURCE = "CalculiX 2.20 and a mortar code, resolved meshes, plane strain, uncertainty 0.1 % (0.3 % at 10 N m)"
TARGETS = {10.0: 0.3, 50.0: 0.1, 100.0: 0.1, 200.0: 0.1, 400.0: 0.1}
# single and double contact, and the tip edge on its mate's flank
DRIVEN = (0.0, 0.165, 0.2, 0.215, 0.35, 0.5)


def rows(torque: float) -> dict[float, tuple[float, float]]:
    """Position by the driving gear and STE in m, by that of the driven gear."""
    with REFERENCE.open(encoding="utf-8") as file:
        return {
            float(row["position_driven"]): (float(row["position_driver"]), 1e-6 * float(row["ste_um"]))
            for row in csv.DictReader(file)
            if row["origin"] == "computed" and float(row["torque_n_m"]) == torque
        }


@pytest.mark.law
@pytest.mark.parametrize(
    "torque",
    [t if t == 100.0 else pytest.param(t, marks=pytest.mark.nightly) for t in TARGETS],
)
def test_positions_under_one_load(torque, record_figure, monkeypatch):
    """Of the codes, too, a plain ring at the root circle stands for all teeth but five."""
    monkeypatch.setattr(gear_boundary, "RAISED", 0.0)
    expected = [rows(torque)[driven] for driven in DRIVEN]
    position, ste = np.array(expected).T
    found = solve_full_contact(PAIR, [torque], position)
    assert not found.failed
    worst = 100.0 * float(np.abs(found.transmission_error[:, 0] / ste - 1.0).max())
    limit = TARGETS[torque]
    name = f"condensed full contact, worst STE, {torque:g} N m"
    record_figure(name, worst, f"at most {limit} %", "%", SOURCE)
    assert worst < limit
    assert max(row[0].residual for row in found.points) < 1e-10


@pytest.mark.law
def test_all_loads_come_from_one_compliance():
    """Meshed for one load or for all: the same within what meshes differ by."""
    alone = solve_full_contact(PAIR, [100.0], [0.2]).transmission_error[0, 0]
    among = solve_full_contact(PAIR, list(TARGETS), [0.2]).transmission_error[0, 2]
    assert among == pytest.approx(alone, rel=5e-4)


def test_meshes_twice_as_fine_change_little(record_figure):
    """At a tip edge, which decides."""
    coarse, fine = (solve_full_contact(PAIR, [400.0], [0.2], Resolution(n)) for n in (3.0, 6.0))
    change = 100.0 * np.abs(coarse.transmission_error / fine.transmission_error - 1.0).max()
    name = "condensed full contact, a_H/3 to a_H/6, 400 N m"
    record_figure(name, float(change), "at most 0.05 %", "%", "its own meshes")
    assert change < 0.05


@pytest.mark.law
def test_pressure_is_that_of_hertz():
    """Of the reference: 755.9 MPa at the pitch point, 592.5 MPa in double contact, within 0.2 % of Hertz."""
    found = solve_full_contact(PAIR, [100.0], [0.0, 0.5])
    for (point,), expected in zip(found.points, (755.9e6, 592.5e6), strict=True):
        assert point.max_pressure == pytest.approx(expected, rel=3e-3)
