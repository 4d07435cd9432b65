"""Plausibility in Python: warned of once in SI units, kept with the result; numbers stay as they are."""

import warnings
from pathlib import Path

import numpy as np
import pytest

from bounds import PlausibilityWarning
from fe_contact import Gear, GearPair, SteDatabase, analyze
from fe_contact.plausibility import flank_findings, pair_findings, root_findings, table_findings
from fe_contact.plausibility.nominal_intensities import (
    nominal_deflection,
    nominal_root_stresses,
    pitch_point_pressure,
)


def pair_of(module: float, unit: float = 1.0) -> GearPair:
    """Return the spur pair of 20 teeth each; its lengths are those of `module`, times `unit`."""
    gear = Gear(20, module * unit, 6.25 * module * unit, 10.0 * module * unit)
    return GearPair(gear, gear, 20.0 * module * unit)


def said_by(pair: GearPair, torque: float) -> tuple[SteDatabase, list[str]]:
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        database = analyze(
            pair, torques=[torque], level="draft", model="plane_strain", receipt="minimal", positions=8
        )
    plausible = [str(one.message) for one in caught if issubclass(one.category, PlausibilityWarning)]
    return database, plausible


def test_millimeters_are_recognized_by_the_line_that_asked(tmp_path):
    """A module of 4 is 4 m; scaled loads give the scaled table, and one warning, which the file keeps."""
    wrong, said = said_by(pair_of(4.0), 100.0e9)
    right, nothing = said_by(pair_of(4.0, 1e-3), 100.0)
    (message,) = said
    assert message.startswith("implausible: normal_module = 4 m: ")
    assert message.endswith("Did you give millimeters, here and in all other lengths?")
    assert nothing == [] and right.warnings == ()
    assert wrong.warnings == (message.removeprefix("implausible: "),)
    np.testing.assert_allclose(
        wrong.static_transmission_error, 1e3 * right.static_transmission_error, rtol=1e-6
    )
    wrong.to_netcdf(tmp_path / "ste.nc")
    assert SteDatabase.from_netcdf(tmp_path / "ste.nc").metadata == wrong.metadata
    with pytest.warns(PlausibilityWarning) as caught:
        analyze(
            pair_of(4.0),
            torques=[100.0e9],
            level="draft",
            model="plane_strain",
            receipt="minimal",
            positions=8,
        )
    assert {Path(one.filename).name for one in caught} == {Path(__file__).name}


def test_torque_in_newton_millimeters_warns_once_of_each_consequence():
    """What the estimates announce before the run is not said again of its results."""
    database, said = said_by(pair_of(4.0, 1e-3), 1e5)
    assert len(said) == len(set(said)) == 4
    checks = [finding["check"] for finding in database.metadata.warnings]
    assert sorted(checks) == ["hertz_pressure", "line_load", "root_stress", "transmission_error"]
    solved = {finding["check"]: finding["field"] for finding in database.metadata.warnings}
    assert solved["hertz_pressure"] == "max_pressure"
    assert solved["transmission_error"] == "transmission_error"


def test_estimates_are_near_what_is_solved():
    """Pressure within 10 % at the pitch point, deflection within 40 %."""
    pair = pair_of(4.0, 1e-3)
    database, _ = said_by(pair, 400.0)
    force = float(database.force[0])
    at_pitch_point = float(database.curve(force=force, at=np.array([0.0])).ste[0])
    assert nominal_deflection(pair, force) == pytest.approx(at_pitch_point, rel=0.4)
    assert database.position[0] == 0.0
    assert pitch_point_pressure(pair, force) == pytest.approx(
        float(database.max_pressure[0, 0, 0, 0]), rel=0.1
    )


def test_the_nominal_root_stress_is_that_of_iso_6336_3():
    """Y_F Y_S of the pinion of 20 teeth without shift, load at the end of single contact: 1.45 x 1.9."""
    pair = pair_of(4.0, 1e-3)
    force = float(pair.normal_force(100.0))
    tangential = 100.0 / pair.pinion.reference_radius
    factor = max(nominal_root_stresses(pair, force)) / (
        tangential / (pair.face_width * pair.pinion.normal_module)
    )
    assert 2.3 < factor < 3.3


def test_findings_begin_at_their_limits():
    """At 2.6 GPa of pressure, 2 GPa at a root and a tenth of the module; failed points are not assessed."""
    table, hertz = np.full((8, 1, 1, 1), 1e-6), ["hertz_pressure"]
    for pressure, checks in ((2.5e9, []), (2.7e9, hertz)):
        assert [finding.check for finding in flank_findings(pressure)] == checks
        assert [finding.check for finding in table_findings(table, 0.0 * table + pressure, 4e-3)] == checks
    assert [len(root_findings("wheel", stress)) for stress in (1.9e9, 2.1e9)] == [0, 1]
    means = (np.full((8, 1, 1, 1), mean) for mean in (0.39e-3, 0.41e-3))
    assert [len(table_findings(mean, 0.0 * mean, 4e-3)) for mean in means] == [0, 1]
    assert table_findings(np.nan * table, np.nan * table, 4e-3) == ()
    assert pair_findings(pair_of(4.0, 1e-3)) == ()
