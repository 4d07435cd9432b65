"""Results in REXS documents: they read back, are marked calculated, and leave the unit as it was."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from rexs_stage import STAGE, stage_unit
from small_table import small_table
from typer.testing import CliRunner

from fe_contact.ste import Metadata, SteDatabase
from lineofaction.cli.commands import app
from lineofaction.gearbox.convert.case import case_json, gear_pair
from lineofaction.gearbox.from_rexs.gear_unit import GearUnit
from lineofaction.gearbox.from_rexs.gears import StageCase, stage_cases
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.rexs.files import parsed, serialized
from lineofaction.gearbox.rexs.model import Attribute, Component, Document
from lineofaction.gearbox.to_rexs import exported


def unit() -> GearUnit:
    return stage_unit()


def stages() -> tuple[StageCase, ...]:
    return stage_cases(unit(), {})


def table() -> SteDatabase:
    (stage,) = stages()
    return replace(small_table(), metadata=Metadata(case=case_json(stage.case)))


def results(document: Document) -> dict[str, Attribute]:
    """Return the calculated attributes of the stage by name."""
    stage = document.model.component(STAGE)
    assert stage is not None
    return {entry.id: entry for entry in stage.attributes if entry.origin == "calculated"}


def test_the_unit_stays_as_it_was_and_reads_back_to_the_same_case() -> None:
    document = Document(unit().model)
    written = exported(document, stages(), [table()])
    for name in ("a.rexs", "a.rexsj", "a.rexsz"):
        read = parsed(serialized(written, name))
        assert read == written
        assert stage_cases(GearUnit(read.model), {}) == stages()
    for before, after in zip(document.model.components, written.model.components, strict=True):
        assert [entry for entry in after.attributes if entry.origin is None] == list(before.attributes)


def test_contact_ratios_are_those_of_the_pair() -> None:
    found = results(exported(Document(unit().model), stages(), [table()]))
    pair = gear_pair(stages()[0].case)
    assert found["radial_contact_ratio"].value == pair.transverse_contact_ratio
    assert found["total_contact_ratio"].value == pair.total_contact_ratio


def test_the_stiffness_is_the_slope_of_force_over_transmission_error() -> None:
    database, step = table(), 1e-4
    torque = float(0.7 * database.torque[-1])
    found = results(exported(Document(unit().model), stages(), [database], torque))
    at = np.array(found["custom_mesh_positions"].value)
    low, high = (database.curve(torque=torque * (1.0 + sign * step), at=at).ste for sign in (-1, 1))
    force = 2.0 * step * torque / database.facts.base_radius[0]
    stiffness = found["meshing_stiffness_characteristic"]
    assert stiffness.value == pytest.approx(1e-3 * force / (high - low), rel=1e-4)
    assert stiffness.unit == "N / mm"


def test_the_transmission_error_is_the_curves() -> None:
    database = table()
    torque = float(database.torque[0])
    found = results(exported(Document(unit().model), stages(), [database], torque))
    curve = database.curve(torque=torque, at=found["custom_mesh_positions"].value)
    assert found["custom_transmission_error"].value == pytest.approx(1e6 * curve.ste)
    whole = 1e6 * curve.peak_to_peak.value
    assert found["custom_transmission_error_peak_to_peak"].value == pytest.approx(whole)
    assert found["custom_transmission_error_harmonics"].unit == "mum"
    assert found["custom_torque_on_driving_gear"].value == pytest.approx(torque)


def test_a_result_takes_the_place_of_an_earlier_one() -> None:
    once = exported(Document(unit().model), stages(), [table()], float(table().torque[0]))
    twice = exported(once, stages(), [table()])
    (stage,) = [part for part in twice.model.components if part.id == STAGE]
    names = [entry.id for entry in stage.attributes]
    assert len(names) == len(set(names))
    assert twice == exported(Document(unit().model), stages(), [table()])


def test_a_table_of_another_pair_is_refused() -> None:
    (stage,) = stages()
    other = case_json(stage.case)
    other["pair"]["pinion"]["tip_relief_um"] = 20.0
    other["pair"]["pinion"]["tip_relief_length_mm"] = 1.0
    with pytest.raises(BadInput, match=stage.name):
        exported(Document(unit().model), stages(), [replace(table(), metadata=Metadata(case=other))])


def test_equal_stages_have_equal_results() -> None:
    model = replace(unit().model, components=(*unit().model.components, Component(21, "cylindrical_stage")))
    (stage,) = stages()
    written = exported(Document(model), [replace(stage, equal=(21,))], [table()])
    first, second = (written.model.component(number) for number in (STAGE, 21))
    assert first is not None
    assert second is not None
    assert set(second.attributes) == set(results(written).values()) != set()


def test_the_verb_writes_what_it_names(tmp_path: Path) -> None:
    unit_file, database, output = (tmp_path / name for name in ("unit.rexs", "ste.nc", "out.rexsj"))
    unit_file.write_bytes(serialized(Document(unit().model), unit_file.name))
    table().to_netcdf(database)
    arguments = ["export", str(database), "--rexs", str(unit_file), "-o", str(output), "--json"]
    result = CliRunner().invoke(app, arguments)
    assert (result.exit_code, result.stderr) == (0, "")
    names = json.loads(result.stdout)["calculated"][str(STAGE)]
    assert set(names) == set(results(parsed(output.read_bytes())))
    refused = CliRunner().invoke(app, [*arguments, "--misalignment-um", "10"])
    assert refused.exit_code == 2
    assert "--misalignment-um" in refused.stderr
