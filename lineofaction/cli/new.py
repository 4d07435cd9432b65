"""``loa new``: first cases and scenes, by rule."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path

from lineofaction.cli.case_text import case_text
from lineofaction.cli.options import PairWishes
from lineofaction.cli.output import check_writable, console, print_written
from lineofaction.cli.pair_sketch import external_pair, internal_pair
from lineofaction.cli.planetary_text import planetary_text
from lineofaction.cli.scene_text import pair_scene_text
from lineofaction.cli.stage_sketch import planetary_stage
from lineofaction.gearbox.convert.boundary_errors import boundary_errors
from lineofaction.gearbox.convert.case import gear_pair
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas import Case, validated
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.schemas.toml import toml_table

_spur = partial(external_pair, teeth=24, ratio=1.5, helix=0.0, module=3.0)
_helical = partial(external_pair, teeth=23, ratio=67 / 23, helix=22.0, module=1.8)
_internal = partial(internal_pair, teeth=36, ratio=96 / 36, module=2.0)
_STAGE = "A planetary stage: the sun drives, the carrier is braked, the ring is held"
_SCENE = "A helical pair between two shafts: motor, brake, four bearings"

KINDS: Mapping[str, Callable[[PairWishes], str]] = {
    "spur": lambda wishes: case_text(_spur(wishes), "A spur pair"),
    "helical": lambda wishes: case_text(_helical(wishes), "A helical pair"),
    "internal": lambda wishes: case_text(_internal(wishes), "A pinion in a ring gear"),
    "planetary": lambda wishes: planetary_text(planetary_stage(wishes), _STAGE),
    "scene": lambda wishes: pair_scene_text(_helical(wishes), _SCENE),
}
"""Writers of first files by the kind of file, which is also the name of the option."""


def run_new(kinds: Mapping[str, bool], wishes: PairWishes, output: Path | None) -> None:
    """Write or print the file of the one kind that was named; a helical pair if none was."""
    named = [kind for kind, chosen in kinds.items() if chosen]
    if len(named) > 1:
        options = " ".join(f"--{kind}" for kind in named)
        raise BadInput.of(
            "kind", options, f"one of {', '.join(f'--{kind}' for kind in KINDS)}", "Choose one."
        )
    if output is not None:
        if output.suffix != ".toml":
            raise BadInput.of("output", str(output), "a file ending in .toml")
        check_writable(output)
        if output.exists():
            raise BadInput.of("output", str(output), "a new file", "Choose another name, or remove it first.")
    text = text_of_kind(named[0] if named else "helical", wishes)
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


def text_of_kind(kind: str, wishes: PairWishes) -> str:
    """Return the file of a kind; the written file is read once as a check that it can be run.

    Raises `BadInput`: no such pair exists.
    """
    with boundary_errors():
        text = KINDS[kind](wishes)
    table = toml_table(text, "file")
    if "shafts" in table:
        scene = validated(SceneInput, table)
        cases = [mesh.case for mesh in scene.meshes if mesh.case is not None]
    else:
        cases = [validated(Case, table)]
    for case in cases:
        gear_pair(case)  # raises for a case that is no pair
    return text
