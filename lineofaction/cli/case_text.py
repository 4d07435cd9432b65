"""The text of a case file: tables with a comment beside every figure."""

from __future__ import annotations

from lineofaction.cli.pair_sketch import LOAD, GearSketch, PairSketch

_PINION, _WHEEL = "the driving gear", "the driven gear"


def case_text(pair: PairSketch, head: str) -> str:
    """Return a case file whose first line is a title."""
    return f"""# {head}
# Made by loa new; every figure may be changed. All fields: docs/case-file.md.
# Next: loa geometry FILE, then loa analyze FILE -o ste.nc, then loa report ste.nc.

{case_tables(pair)}
[accuracy]
tolerance = 0.02 # relative, of mean and peak-to-peak STE; or level = "draft" for a first look
"""


def case_tables(pair: PairSketch, prefix: str = "") -> str:
    """Return the tables of a case but for its accuracy, within another table if `prefix` names it."""
    torques = ", ".join(f"{torque:g}" for torque in pair.torque)
    helix = f"helix_angle_deg = {pair.helix:g} # of the pinion; > 0: right hand\n" if pair.helix else ""
    return f"""[{prefix}pair]
normal_module_mm = {pair.module:g}
{helix}center_distance_mm = {pair.center_distance:.10g}

[{prefix}pair.pinion] # {_PINION}
{_external_gear(pair, pair.pinion)}
[{prefix}pair.wheel] # {_WHEEL}
{_wheel_fields(pair)}
[{prefix}load]
torque_n_m = [{torques}] # on the pinion, to {LOAD:g} N/mm^2 of tangential force over face width and module
"""


def _wheel_fields(pair: PairSketch) -> str:
    if not pair.internal:
        return _external_gear(pair, pair.wheel)
    wheel = pair.wheel
    return f"""internal = true # a ring gear
teeth = {wheel.teeth}
face_width_mm = {pair.width:g}
rim_diameter_mm = {wheel.bore:g} # outside of the rim, which is held
addendum_coefficient = {pair.ring_addendum:g} # the full addendum would meet the pinion below its involute
thickness_allowance_um = {wheel.allowance:g} # is backlash
"""


def _external_gear(pair: PairSketch, gear: GearSketch) -> str:
    relief, length = pair.relief
    shift = (
        f"profile_shift_coefficient = {gear.shift:g} # balances the sliding of both roots\n"
        if gear.shift
        else ""
    )
    allowance = f"thickness_allowance_um = {gear.allowance:g} # is backlash\n" if gear.allowance else ""
    return f"""teeth = {gear.teeth}
face_width_mm = {pair.width:g}
bore_diameter_mm = {gear.bore:g}
{shift}{allowance}tip_relief_um = {relief:g}
tip_relief_length_mm = {length:g} # along the radius
helix_crowning_um = {pair.crowning:g} # at both ends of the face
"""
