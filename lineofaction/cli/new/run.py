"""``loa new``."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from pathlib import Path

from lineofaction.cli.new.case_text import case_text
from lineofaction.cli.new.planetary_text import planetary_stage, planetary_text
from lineofaction.cli.new.scene_text import pair_scene_text
from lineofaction.cli.new.sketch import external_pair, internal_pair
from lineofaction.cli.new.wanted import Wanted
from lineofaction.cli.output import check_writable, console
from lineofaction.gearbox.convert.case import boundary_errors, gear_pair
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas import Case, validated
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.schemas.toml_table import toml_table


def _spur(wanted: Wanted) -> str:
    """Return an industrial spur pair."""
    return case_text(external_pair(wanted, teeth=24, ratio=1.5, helix=0.0, module=3.0), "A spur pair")


def _helical(wanted: Wanted) -> str:
    """Return a helical pair as in an EV reducer."""
    pair = external_pair(wanted, teeth=23, ratio=67 / 23, helix=22.0, module=1.8)
    return case_text(pair, "A helical pair")


def _internal(wanted: Wanted) -> str:
    """Return a pinion in a ring gear."""
    return case_text(internal_pair(wanted, teeth=36, ratio=96 / 36, module=2.0), "A pinion in a ring gear")


def _planetary(wanted: Wanted) -> str:
    """Return a planetary stage."""
    head = "A planetary stage: the sun drives, the carrier is braked, the ring is held"
    return planetary_text(planetary_stage(wanted), head)


def _scene(wanted: Wanted) -> str:
    """Return a helical pair between two shafts."""
    pair = external_pair(wanted, teeth=23, ratio=67 / 23, helix=22.0, module=1.8)
    return pair_scene_text(pair, "A helical pair between two shafts: motor, brake, four bearings")


KINDS: Mapping[str, Callable[[Wanted], str]] = {
    "spur": _spur,
    "helical": _helical,
    "internal": _internal,
    "planetary": _planetary,
    "scene": _scene,
}
"""What is made, by the option that names it."""


def run_new(kinds: Mapping[str, bool], wanted: Wanted, output: Path | None) -> None:
    """Write or print the file of the one kind that was named; a helical pair if none was."""
    named = [kind for kind, chosen in kinds.items() if chosen]
    if len(named) > 1:
        given = " ".join(f"--{kind}" for kind in named)
        raise BadInput.of("kind", given, f"one of {', '.join(f'--{kind}' for kind in KINDS)}", "Choose one.")
    if output is not None:
        _check_new(output)
    text = new_text(named[0] if named else "helical", wanted)
    if output is None:
        sys.stdout.write(text)
        return
    output.write_text(text, encoding="utf-8")
    verb = "simulate" if "[[shafts]]" in text else "geometry"
    out = console()
    out.print(text.partition("\n")[0].removeprefix("# "), highlight=False)
    out.print(f"next: loa {verb} {output}" + (" -o run.nc" if verb == "simulate" else ""), highlight=False)
    out.print(f"written to {output}", highlight=False)


def new_text(kind: str, wanted: Wanted) -> str:
    """Return the file of a kind; it is read once, so that what is written can be run.

    Raises
    ------
    BadInput
        No such pair exists.
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


def _check_new(output: Path) -> None:
    """Refuse a file that exists, and one that is no TOML by its name."""
    if output.suffix != ".toml":
        raise BadInput.of("output", str(output), "a file ending in .toml")
    check_writable(output)
    if output.exists():
        raise BadInput.of("output", str(output), "a new file", "Choose another name, or remove it first.")
