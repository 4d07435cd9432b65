"""``loa housing``: a STEP file as the housing of a scene."""

from __future__ import annotations

import json
import shutil
from collections.abc import Collection
from contextlib import suppress
from itertools import chain, count
from pathlib import Path
from typing import Any

import numpy as np

from bounds import engineering
from dynamics.errors import InputError, SolveError
from dynamics.housings import step_solid
from dynamics.solid_housing import MATERIALS
from host.directories import atomic_file
from lineofaction.cli.output import check_writable, console, print_json, print_written, table
from lineofaction.cli.verb_warnings import warn
from lineofaction.gearbox.convert.placement import Placement
from lineofaction.gearbox.from_step.housing import DIRECTIONS, StepHousing, even_length, step_housing
from lineofaction.gearbox.input_file import InputFile
from lineofaction.gearbox.number_list import number_list
from lineofaction.gearbox.problems import BadInput, JobFailed
from lineofaction.gearbox.schemas.files import READERS, written_out
from lineofaction.gearbox.schemas.housing_solid import PERPENDICULAR
from lineofaction.gearbox.schemas.named_files import in_folder, read_text
from lineofaction.gearbox.schemas.plan import omission_warnings
from lineofaction.gearbox.schemas.reading import read_model, read_table, validated
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.schemas.toml import toml_table, toml_text
from lineofaction.gearbox.units import MM

NAMES = {"origin_mm": "--origin-mm", "x_axis": "--x-axis", "z_axis": "--z-axis"}


def run_housing(
    file: InputFile,
    step: Path,
    material: str,
    stands_on: str,
    placed: dict[str, str | None],
    output: Path | None,
    *,
    as_json: bool,
) -> None:
    """Show the housing that a STEP file makes of a scene, and write the scene with it.

    The scene of a folder is written in place unless another file is named.

    Parameters
    ----------
    stands_on : str
        Direction that the foot of the housing looks to.
    placed : dict
        Typed values of `NAMES`, by field.
    """
    _check_known("--material", material, MATERIALS)
    _check_known("--stands-on", stands_on, DIRECTIONS)
    if output is None and file.project is not None:
        output = file.path
    if output is not None:
        check_writable(output)
    scene = read_model(SceneInput, file)
    try:
        solid = step_solid(step)
    except InputError as error:
        raise BadInput.of(error.field, error.value, str(error.bound), str(error.suggestion)) from None
    except SolveError as error:
        raise JobFailed(f'"{step.name}": {error}') from error
    made = step_housing(scene, solid, material, stands_on, _placement(placed))
    left = [f"{name}: in no bore, it stays on the ground" for name in made.omitted]
    warn(omission_warnings(left, "scene"))
    written = [] if output is None else _write(file, step, output, made)
    if as_json:
        print_json(_as_json(made) | {"written": [str(path) for path in written]})
        return
    _show(made)
    print_written(written)


def _check_known(name: str, value: str, known: Collection[str]) -> None:
    if value not in known:
        raise BadInput.of(name, value, f"one of {', '.join(known)}")


def _placement(placed: dict[str, str | None]) -> Placement | None:
    """Return the placement of the file by the options; None: no option states it."""
    vectors = {field: _vector(NAMES[field], text) for field, text in placed.items() if text is not None}
    if not vectors:
        return None
    x = vectors.get("x_axis", np.array([1.0, 0.0, 0.0]))
    z = vectors.get("z_axis", np.array([0.0, 0.0, 1.0]))
    for field, axis in (("x_axis", x), ("z_axis", z)):
        if not axis.any():
            raise BadInput.of(NAMES[field], axis.tolist(), "a direction: not all zero")
    if abs(x @ z) > PERPENDICULAR * np.linalg.norm(x) * np.linalg.norm(z):
        raise BadInput.of(NAMES["x_axis"], x.tolist(), f"perpendicular to the z axis, {z.tolist()}")
    return Placement.of(x, z, vectors.get("origin_mm", np.zeros(3)))


def _vector(option: str, text: str) -> Any:
    values = np.array(number_list(option, text))
    if values.shape != (3,) or not np.all(np.isfinite(values)):
        raise BadInput.of(option, text, "three numbers x,y,z", "For example 0,0,60.")
    return values


def _write(file: InputFile, step: Path, output: Path, made: StepHousing) -> list[Path]:
    """Write the scene with its housing, and the STEP file beside it; return the files.

    A file of another content under its name is replaced where only the housing that is replaced has it.
    """
    target = output.parent / step.name
    in_place = target.exists() and target.samefile(step)
    base = read_table(file)
    housings = base.get("housings", [])
    others = [part for part in housings if part.get("name") not in made.replaced]
    of_file = [part for part in housings if part.get("step_file") == step.name]
    revised = output == file.path and of_file and not any(part in others for part in of_file)
    free = in_place or revised or not target.exists()
    if not free and target.read_bytes() != step.read_bytes():
        raise BadInput.of("output", str(target), "free for the STEP file", "Choose another folder or name.")
    name = made.replaced[0] if made.replaced else _new_name({part.get("name") for part in others})
    housing = {"name": name, "step_file": step.name, **made.fields}
    table = base | {"housings": [*others, housing]}
    in_output_folder = in_folder(output.parent)

    def find(name: str, field: str) -> Path:
        return step if name == step.name else in_output_folder(name, field)

    validated(SceneInput, written_out(table, find, READERS))
    text = _text(file, output, table, housing)
    if not in_place:  # first: a scene names no file that is missing
        with atomic_file(target) as draft:
            shutil.copyfile(step, draft)
    with atomic_file(output) as draft:
        draft.write_text(text, encoding="utf-8")
    return [output] if in_place else [output, target]


def _new_name(used: Collection[Any]) -> str:
    names = chain(["housing"], (f"housing {number}" for number in count(2)))
    return next(name for name in names if name not in used)


def _text(file: InputFile, output: Path, table: dict[str, Any], housing: dict[str, Any]) -> str:
    """Return the scene as a file.

    If the housing at the end of the file, or in place of its last one, makes that scene, the file keeps its
    comments.
    """
    if output.suffix == ".json":
        return json.dumps(table, indent=1) + "\n"
    original = read_text(file.path, str(file.path))
    for base in (original, original.rpartition("[[housings]]")[0]):
        text = f"{base.rstrip()}\n\n{toml_text({'housings': [housing]})}"
        with suppress(BadInput):
            if toml_table(text, str(file.path)) == table:
                return text
    return toml_text(table)


def _show(made: StepHousing) -> None:
    out = console()
    rows = [_row(name, made) for name in made.seated.bores]
    head = ("bearing", "bore, mm", "length, mm", "bearing off its middle, mm")
    stand = made.stand
    normal = next(name for name, axis in DIRECTIONS.items() if np.array_equal(axis, stand.normal))
    faces = "face" if stand.faces == 1 else "faces"
    level = engineering(float(abs(stand.normal) @ stand.point) / MM, 6)
    out.print(
        f"{engineering(made.mass)} kg, walls of {engineering(made.wall / MM)} mm in the mean (2 V/S)\n"
        f"stands on {stand.faces} {faces} of {engineering(1e4 * stand.area)} cm² that look to {normal}, "
        f"at {normal[1]} = {level} mm"
    )
    if made.replaced:
        out.print(f"in place of the housing {', '.join(made.replaced)}", soft_wrap=True)
    if made.fields.keys() & NAMES.keys():
        placed = ", ".join(f"{name} = {made.fields[name]}" for name in NAMES if name in made.fields)
        out.print(f"where the file stands, by its bores or as typed: {placed}", soft_wrap=True)
    if (size := made.fields.get("element_size_mm")) is not None:
        out.print(f"element_size_mm = {size}: as fine as the shortest of these seats needs", soft_wrap=True)
    out.print(table(head, rows, "", ("bearing",)))


def _row(name: str, made: StepHousing) -> tuple[str, ...]:
    bore = made.seated.bores[name]
    off = abs(bore.position[2] - made.seated.bearings[name][2])
    lengths = bore.diameter, even_length(made.seated, name), round(off, 9)  # off: to 1 nm, above rounding
    return name, *(engineering(length / MM, 5) for length in lengths)


def _as_json(made: StepHousing) -> dict[str, Any]:
    stand = made.stand
    return {
        "housing": made.fields,
        "mass_kg": made.mass,
        "mean_wall_mm": made.wall / MM,
        "left_out": list(made.omitted),
        "foot_faces": stand.faces,
        "foot_area_mm2": stand.area / MM**2,
    }
