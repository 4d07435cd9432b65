"""``loa new`` and ``loa open``: first cases and scenes, by rule or from a file of another tool."""

from __future__ import annotations

import math
import sys
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path

from lineofaction.cli.guard import warn
from lineofaction.cli.options import PairWishes
from lineofaction.cli.output import check_writable, console, print_json, print_written
from lineofaction.cli.pair_sketch import (
    LOAD,
    PLANETS,
    GearSketch,
    PairSketch,
    StageSketch,
    external_pair,
    internal_pair,
    planetary_stage,
)
from lineofaction.gearbox.convert.case import boundary_errors, gear_pair
from lineofaction.gearbox.from_rexs.account import FATES
from lineofaction.gearbox.from_rexs.assumptions import Assumption
from lineofaction.gearbox.from_rexs.opened import OpenedUnit
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.rexs.files import read_rexs
from lineofaction.gearbox.schemas import Case, validated
from lineofaction.gearbox.schemas.plan import left_out_warnings
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.schemas.toml import toml_table

# The text of a case file: tables with a comment beside every figure.


_PINION, _WHEEL = "the driving gear", "the driven gear"


def _case_text(pair: PairSketch, head: str) -> str:
    """Return a case file under a line that says what it holds."""
    return f"""# {head}
# Made by loa new; every figure may be changed. All fields: docs/case-file.md.
# Next: loa geometry FILE, then loa analyze FILE -o ste.nc, then loa report ste.nc.

{_case_tables(pair)}
[accuracy]
tolerance = 0.02 # relative, of mean and peak-to-peak STE; or level = "draft" for a first look
"""


def _case_tables(pair: PairSketch, prefix: str = "") -> str:
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
rim_diameter_mm = {wheel.held:g} # outside of the rim, which is held
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
bore_diameter_mm = {gear.held:g}
{shift}{allowance}tip_relief_um = {relief:g}
tip_relief_length_mm = {length:g} # along the radius
helix_crowning_um = {pair.crowning:g} # at both ends of the face
"""


# The text of scene files: a pair between two shafts, and a planetary stage.


HEAD = """# {head}
# Made by loa new; every figure may be changed. All fields: docs/case-file.md#scene.
# Next: loa simulate FILE -o run.nc, then loa report run.nc; loa modes FILE for natural frequencies.
"""
ACCURACY = """
[meshes.case.accuracy]
level = "draft" # a table for a first run; "standard" or a tolerance once the scene is right
"""


def _pair_scene_text(pair: PairSketch, head: str) -> str:
    """Return a motor, a pair between two shafts on two bearings each, and a brake; the motor runs up."""
    length = 4.0 * pair.width
    sides = (("input", "pinion", pair.pinion, 0.0), ("output", "wheel", pair.wheel, pair.center_distance))
    shafts = "".join(
        _shaft(name, length, gear.held, origin)
        + _gear(tooth, name, 0.5 * length, gear.held)
        + _scene_text_bearings(name, length)
        for name, tooth, gear, origin in sides
    )
    load = pair.torque[-2] * pair.wheel.teeth / pair.pinion.teeth
    return f"""{HEAD.format(head=head)}
[run]
duration_s = 1.0
{shafts}
[[meshes]]
name = "mesh"
driver = "pinion"
driven = "wheel"
damping_ratio = 0.07 # measured ones lie between 0.03 and 0.17

{_case_tables(pair, "meshes.case.")}{ACCURACY}
[[drives]] # the angle is imposed: a run-up
name = "motor"
shaft = "input"
time_s = [0.0, 1.0]
speed_rpm = [300.0, 3000.0]

[[loads]]
name = "brake"
shaft = "output"
torque_n_m = [{load:.4g}] # three quarters of the table's highest load

[outputs]
bearing_forces = true
"""


def _shaft(name: str, length: float, diameter: float, origin: float) -> str:
    return f"""
[[shafts]]
name = "{name}"
length_mm = {length:g}
diameter_mm = {diameter:g}
origin_mm = [{origin:.10g}, 0.0, 0.0]
"""


def _gear(name: str, shaft: str, position: float, bore: float) -> str:
    """Return a gear whose body follows from its case."""
    return f"""
[[gears]]
name = "{name}"
shaft = "{shaft}"
position_mm = {position:g} # along the shaft
bore_diameter_mm = {bore:g}
"""


def _scene_text_bearings(shaft: str, length: float) -> str:
    """Return the two bearings of a shaft; the left one carries the axial force."""
    return "".join(
        f"""
[[bushings]]
name = "{shaft} {side}"
shaft = "{shaft}"
position_mm = {position:g}
radial_stiffness_n_per_m = 3e8
{"axial_stiffness_n_per_m = 1e8" + chr(10) if side == "left" else ""}damping_ratio = 0.02
"""
        for side, position in (("left", 0.0), ("right", length))
    )


# The text of a scene file of a planetary stage.


_LOAD_SHARE = 0.6
"""Of the sun's highest torque in the table."""


def _planetary_text(stage: StageSketch, head: str) -> str:
    """Return a stage whose sun is driven, whose carrier is braked, and whose ring is held."""
    length = 2.0 * stage.sun.width
    middle = 0.5 * length
    brake = PLANETS * _LOAD_SHARE * stage.sun.torque[-1] * stage.ratio
    return f"""{HEAD.format(head=head)}
[run]
duration_s = 0.5
{_shafts(stage, length)}{_gears(stage, middle)}{_bearings(middle)}
[[planets]] # all are copies of the first
planet = "planet"
number = {PLANETS}

[[meshes]]
name = "sun mesh"
driver = "sun gear"
driven = "planet gear"
damping_ratio = 0.07 # measured ones lie between 0.03 and 0.17

{_case_tables(stage.sun, "meshes.case.")}{ACCURACY}
[[meshes]]
name = "ring mesh"
driver = "planet gear"
driven = "ring gear"
damping_ratio = 0.07

{_case_tables(stage.ring, "meshes.case.")}{ACCURACY}
[[drives]] # the angle is imposed: a run-up
name = "motor"
shaft = "sun"
time_s = [0.0, 0.5]
speed_rpm = [300.0, 1500.0]

[[drives]]
name = "ring held"
shaft = "ring"
speed_rpm = [0.0]

[[loads]]
name = "brake"
shaft = "carrier"
torque_n_m = [{brake:.3g}]
"""


def _shafts(stage: StageSketch, length: float) -> str:
    """Return carrier, sun, ring and the first planet; inertia of the carrier grows as its size."""
    radius = 1e-3 * stage.sun.center_distance
    mass = 800.0 * radius**2 * 1e-3 * length * math.pi * 7.85
    none = "{ mass_kg = 0.0, polar_kg_m2 = 0.0, transverse_kg_m2 = 0.0 }"
    polar = 0.5 * mass * radius**2
    carrier = f"{{ mass_kg = {mass:.3g}, polar_kg_m2 = {polar:.3g}, transverse_kg_m2 = {0.6 * polar:.3g} }}"
    return f"""
[[shafts]]
name = "carrier"
frame = "carrier" # a carrier names itself
length_mm = {length:g}
inertia = {carrier}

[[shafts]]
name = "sun"
frame = "carrier"
length_mm = {length:g}
diameter_mm = {stage.sun.pinion.held:g}

[[shafts]]
name = "ring"
frame = "carrier"
length_mm = {length:g}
inertia = {none}

[[shafts]] # the first planet
name = "planet"
frame = "carrier"
length_mm = {length:g}
diameter_mm = {stage.sun.wheel.held:g}
origin_mm = [{stage.sun.center_distance:.10g}, 0.0, 0.0]
"""


def _gears(stage: StageSketch, middle: float) -> str:
    """Return the gears at mid-length; the ring's inertia counts for nothing while it is held."""
    return f"""
[[gears]]
name = "sun gear"
shaft = "sun"
position_mm = {middle:g}
bore_diameter_mm = {stage.sun.pinion.held:g}

[[gears]]
name = "planet gear"
shaft = "planet"
position_mm = {middle:g}
bore_diameter_mm = {stage.sun.wheel.held:g}

[[gears]]
name = "ring gear"
shaft = "ring"
position_mm = {middle:g}
inertia = {{ mass_kg = 1.0, polar_kg_m2 = 1e-2, transverse_kg_m2 = 5e-3 }}
"""


def _bearings(middle: float) -> str:
    """Return the sun's soft bearing, the ring's mount, the carrier's bearing and the planet's pin."""
    return (
        "".join(
            f"""
[[bushings]]
name = "{name}"
shaft = "{shaft}"
position_mm = {middle:g}
radial_stiffness_n_per_m = {stiffness}
axial_stiffness_n_per_m = 1e8
"""
            for name, shaft, stiffness in (
                ("sun bearing", "sun", "1e6 # soft: the sun floats between the planets"),
                ("ring mount", "ring", "1e9"),
                ("carrier bearing", "carrier", "2e8"),
            )
        )
        + f"""
[[planet_bearings]]
name = "pin"
shaft = "planet"
carrier = "carrier"
position_mm = {middle:g}
radial_stiffness_n_per_m = 2e8
axial_stiffness_n_per_m = 1e8
"""
    )


_spur = partial(external_pair, teeth=24, ratio=1.5, helix=0.0, module=3.0)
_helical = partial(external_pair, teeth=23, ratio=67 / 23, helix=22.0, module=1.8)
_internal = partial(internal_pair, teeth=36, ratio=96 / 36, module=2.0)
_STAGE = "A planetary stage: the sun drives, the carrier is braked, the ring is held"
_SCENE = "A helical pair between two shafts: motor, brake, four bearings"

KINDS: Mapping[str, Callable[[PairWishes], str]] = {
    "spur": lambda wanted: _case_text(_spur(wanted), "A spur pair"),
    "helical": lambda wanted: _case_text(_helical(wanted), "A helical pair"),
    "internal": lambda wanted: _case_text(_internal(wanted), "A pinion in a ring gear"),
    "planetary": lambda wanted: _planetary_text(planetary_stage(wanted), _STAGE),
    "scene": lambda wanted: _pair_scene_text(_helical(wanted), _SCENE),
}
"""What is made, by the option that names it."""


def run_new(kinds: Mapping[str, bool], wanted: PairWishes, output: Path | None) -> None:
    """Write or print the file of the one kind that was named; a helical pair if none was."""
    named = [kind for kind, chosen in kinds.items() if chosen]
    if len(named) > 1:
        given = " ".join(f"--{kind}" for kind in named)
        raise BadInput.of("kind", given, f"one of {', '.join(f'--{kind}' for kind in KINDS)}", "Choose one.")
    if output is not None:
        if output.suffix != ".toml":
            raise BadInput.of("output", str(output), "a file ending in .toml")
        check_writable(output)
        if output.exists():
            raise BadInput.of("output", str(output), "a new file", "Choose another name, or remove it first.")
    text = _new_text(named[0] if named else "helical", wanted)
    if output is None:
        sys.stdout.write(text)
        return
    output.write_text(text, encoding="utf-8")
    verb = "simulate" if "[[shafts]]" in text else "geometry"
    out = console()
    out.print(text.partition("\n")[0].removeprefix("# "))
    ending = " -o run.nc" if verb == "simulate" else ""
    out.print(f"next: loa {verb} {output}{ending}", soft_wrap=True)
    print_written([output])


def _new_text(kind: str, wanted: PairWishes) -> str:
    """Return the file of a kind; it is read once, so that what is written can be run.

    Raises `BadInput`: no such pair exists.
    """
    with boundary_errors():
        text = KINDS[kind](wanted)
    table = toml_table(text, "file")
    if "shafts" in table:
        scene = validated(SceneInput, table)
        cases = [mesh.case for mesh in scene.meshes if mesh.case is not None]
    else:
        cases = [validated(Case, table)]
    for case in cases:
        gear_pair(case)
    return text


# ``loa open``.


def run_open(file: Path, output: Path | None, assume: Sequence[str] = (), *, as_json: bool) -> None:
    """Open a REXS file: write cases, scene, load cases and account, and print what is not taken as it is.

    What is left out of the scene comes first and last.
    """
    unit = OpenedUnit.of(read_rexs(file), [Assumption.of(text) for text in assume])
    folder = output or Path(file.name).with_suffix("")
    written = _write_unit(unit, folder)
    counts = Counter[str](line.fate for line in unit.lines)
    left_out = unit.headline
    if left_out and not as_json:
        console().print(left_out, soft_wrap=True)
    warn(left_out_warnings(unit.left_out))
    if as_json:
        print_json(
            {
                "written": [str(path) for path in written],
                "cases": [case.name for case in unit.cases],
                "scene": unit.scene is not None,
                "load_cases": [case.table() for case in unit.load_cases],
                "account": {fate: counts[fate] for fate in FATES},
                "lines": list(unit.summary()),
            }
        )
        return
    _show_unit(unit, counts, written)
    if left_out:
        console().print(left_out, soft_wrap=True)


def _write_unit(unit: OpenedUnit, folder: Path) -> list[Path]:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise BadInput.of("output", str(folder), f"a folder that can be made ({error.strerror})") from None
    written = []
    for name, text in unit.files().items():
        path = folder / name
        path.write_text(text, encoding="utf-8")
        written.append(path)
    return written


def _show_unit(unit: OpenedUnit, counts: Counter[str], written: list[Path]) -> None:
    out = console()
    values = ", ".join(f"{counts[fate]} {fate}" for fate in FATES if counts[fate])
    out.print(f"{len(unit.lines)} components and values: {values}", soft_wrap=True)
    for line in unit.summary(("assumed", "defaulted", "derived")):
        out.print(line, soft_wrap=True)
    for case in unit.cases:
        others = f" (and {len(case.equal)} equal)" if case.equal else ""
        gears = f"gears {case.driver} and {case.driven}, {case.center_distance * 1e3:.6g} mm"
        out.print(f"stage {case.stage}{others}: {case.name}.toml, {gears}")
    for load in unit.load_cases:
        words = f"{load.torque_n_m:g} N m at {load.speed_rpm:g} rpm, {load.direction}, share {load.share:g}"
        others = "".join(
            f", {force['name']} {force['force_n']} N and {force['moment_n_m']} N m in x, y, z"
            for force in load.forces
        )
        out.print(f"{load.name}: {words}{others}", soft_wrap=True)
    print_written(written)
