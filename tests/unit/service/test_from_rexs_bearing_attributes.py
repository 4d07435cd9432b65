"""The page lists the attributes of bearings that are read from files of REXS."""

from __future__ import annotations

import re
from pathlib import Path

from rexs_bearing_units import BALL, ROW, inside, on_lines

from lineofaction.gearbox.from_rexs.opened import opened
from lineofaction.gearbox.schemas.bearings import BallRowInput, RollerRowInput, RollingBearingInput

ROLES = {"support_vector", "u_axis_vector", "w_axis_vector", "reference_component_for_position"}
PAGE = Path(__file__).parents[3] / "docs" / "reference" / "rexs-bearings.md"


def read_attributes() -> set[str]:
    """Return the attributes of bearings, rows and elements that units of every kind are read by."""
    stages = ("operating_", "mounted_", "")
    clearances = [{f"{stage}radial_bearing_clearance": 10.0} for stage in stages]
    limits = {f"{end}_radial_bearing_clearance": 10.0 for end in ("minimum", "maximum")}
    missing = {"operating_radial_bearing_clearance": None}
    units = [on_lines(missing | own) for own in (*clearances, limits)]
    sides = [{f"axial_force_absorption{of}": "positive" for of in ("", "_of_row")}] * 2
    along = [{f"{stage}axial_bearing_clearance": 10.0} for stage in stages]
    along += [{"preload_distance": 8.0}, {"preload_force": 100.0}]
    units += [inside(*(side | own for side in sides)) for own in along]
    lengths, grooves = ROW | {"significant_contact_length_inner_ring": 12.0}, dict(ROW)
    grooves |= {f"raceway_radius_of_{ring}_ring": 4.7 for ring in ("inner", "outer")}
    ball = {"bearing_type": "angular_contact_ball_bearing"}
    units += [inside(*sides, row=lengths), inside(*(side | ball for side in sides), grooves, BALL)]
    lines = [line for unit in units for line in opened(unit).lines if "rolling" in line.kind]
    stated = {line.item for line in lines if line.item and line.fate in ("taken", "derived")}
    return stated - ROLES - {"u_coordinate_on_shaft_inner_side"}


def test_the_page_lists_the_attributes_that_are_read() -> None:
    rows = [row.split("|") for row in PAGE.read_text("utf-8").splitlines() if row.startswith("| ")]
    listed = {name for row in rows[1:] for name in re.findall(r"`([a-z_]+)`", row[2])}
    assert listed == read_attributes()
    fields = {name for row in rows[1:] for name in re.findall(r"`([a-z_]+)`", row[3])}
    models = (RollingBearingInput, BallRowInput, RollerRowInput)
    assert fields <= {name for model in models for name in model.model_fields}
