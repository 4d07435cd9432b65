"""``loa new`` and ``loa open``: first cases and scenes, by rule or from a file of another tool."""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path

from lineofaction.cli.case_text import case_text
from lineofaction.cli.options import PairWishes
from lineofaction.cli.output import check_writable, console, print_json, print_written
from lineofaction.cli.pair_sketch import external_pair, internal_pair
from lineofaction.cli.planetary_text import planetary_text
from lineofaction.cli.scene_text import pair_scene_text
from lineofaction.cli.stage_sketch import planetary_stage
from lineofaction.cli.verb_warnings import warn
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

_spur = partial(external_pair, teeth=24, ratio=1.5, helix=0.0, module=3.0)
_helical = partial(external_pair, teeth=23, ratio=67 / 23, helix=22.0, module=1.8)
_internal = partial(internal_pair, teeth=36, ratio=96 / 36, module=2.0)
_STAGE = "A planetary stage: the sun drives, the carrier is braked, the ring is held"
_SCENE = "A helical pair between two shafts: motor, brake, four bearings"


KINDS: Mapping[str, Callable[[PairWishes], str]] = {
    "spur": lambda wanted: case_text(_spur(wanted), "A spur pair"),
    "helical": lambda wanted: case_text(_helical(wanted), "A helical pair"),
    "internal": lambda wanted: case_text(_internal(wanted), "A pinion in a ring gear"),
    "planetary": lambda wanted: planetary_text(planetary_stage(wanted), _STAGE),
    "scene": lambda wanted: pair_scene_text(_helical(wanted), _SCENE),
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
