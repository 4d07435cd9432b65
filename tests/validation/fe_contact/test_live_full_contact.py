"""The run of CalculiX beside the ladder against resolved full contact, where it is installed."""

from __future__ import annotations

import csv
from pathlib import Path

import pytest

from fe_contact import Gear, GearPair
from fe_contact.full_contact import find_calculix, full_contact_mesh, solve_position

REFERENCE = Path(__file__).parents[2] / "reference" / "spur_20_20_full_contact.csv"
TORQUE, POSITION = 400.0, 0.5  # mid double contact: nine iterations


@pytest.mark.skipif(find_calculix() is None, reason="CalculiX (ccx) is not installed")
def test_the_usual_mesh_reproduces_the_resolved_contact():
    """Its meshes are up to six times as fine; 5 real teeth and plane strain in both. Found: -0.17 %."""
    gear = Gear(teeth=20, normal_module=4e-3, face_width=25e-3, bore_diameter=40e-3)
    pair = GearPair(gear, gear, center_distance=80e-3)
    force = float(pair.normal_force(TORQUE))
    point = solve_position(find_calculix(), pair, full_contact_mesh(pair, force), force, POSITION, 300.0)
    assert point.status.usable, point.reason
    with REFERENCE.open(encoding="utf-8") as file:
        (row,) = (
            row
            for row in csv.DictReader(file)
            if float(row["torque_n_m"]) == TORQUE and float(row["position_driven"]) == POSITION
        )
    assert point.transmission_error == pytest.approx(1e-6 * float(row["ste_um"]), rel=3e-3, abs=0.0)
    assert point.position == pytest.approx(float(row["position_driver"]), abs=1e-5)
