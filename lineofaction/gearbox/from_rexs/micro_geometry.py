"""The modified flank of a gear: fields of a case, and a grid of what has no field."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from bounds import engineering
from fe_contact.geometry import FlankGrid, Toothing
from fe_contact.types import FloatArray
from lineofaction.gearbox.convert.case import boundary_errors
from lineofaction.gearbox.from_rexs.gear_unit import Part, rounded
from lineofaction.gearbox.from_rexs.meshing import LoadedFlank
from lineofaction.gearbox.from_rexs.modifications import READERS, UNREAD, FlankPlace, Modification
from lineofaction.gearbox.units import MM, UM

Table = dict[str, Any]


def micro_geometry(gear: Toothing, loaded: LoadedFlank) -> Table:
    """Return the fields of the loaded flank's modifications, empty for an involute helicoid.

    What has no field, or a field that another modification takes, is summed on the case's `flank_grid`; the
    account has the grid's largest difference.
    `gear` is without modifications.
    """
    if loaded.flank is None:
        return {}
    place = FlankPlace(gear, loaded)
    entries = _at_both_ends(place, list(_modifications(place, loaded.flank)))
    fields: Table = _tip_edge(place, loaded.flank)
    rest: list[Modification] = []
    for entry in entries:
        if entry.fields and not set(entry.fields) & set(fields):
            fields |= entry.fields
        else:
            rest.append(entry)
    if rest:
        for count in _COUNTS:
            raster = _on_grid(place, rest, count)
            if raster.difference <= _ALLOWED:
                break
        fields["flank_grid"] = raster.table
        lines = f"{raster.counts[0]} roll lengths by {raster.counts[1]} face positions"
        words = f"{', '.join(entry.part.name for entry in rest)} on {lines}; differs by at most"
        loaded.flank.say("flank_grid", "derived", f"{words} {engineering(raster.difference / UM, 2)} µm")
    return fields


def _modifications(place: FlankPlace, flank: Part) -> Iterator[Modification]:
    """Yield the modifications of a flank; state which are left aside, or read otherwise than written."""
    for part in (*flank.referenced, *flank.children()):
        if part.type in UNREAD:
            part.say("", *UNREAD[part.type])
        if part.type not in READERS:
            continue
        item = "position_of_profile_modification"
        if part.attribute(item) is not None:
            part.say(item, "ignored", "the profile is the same all over the face")
        item, words = "is_additive_modification", "modifications add up"
        if part.text(item, words) == "False":
            part.say(item, "ignored", words)
        yield READERS[part.type](place, part)


def _at_both_ends(place: FlankPlace, modifications: Sequence[Modification]) -> list[Modification]:
    """Return the modifications with end reliefs that are alike at both faces as one."""
    ends = [entry for entry in modifications if entry.part.type.startswith("end_relief_")]
    plain = [{_both(name): value for name, value in entry.fields.items()} for entry in ends]
    alike = len(ends) == 2 and ends[0].part.type != ends[1].part.type and plain[0] == plain[1]
    if not alike or not plain[0] or plain[0]["end_relief_length_mm"] > 0.5e3 * place.width:
        return list(modifications)
    first, second = ends
    both = replace(
        first,
        removed=lambda roll, face: first.removed(roll, face) + second.removed(roll, face),
        fields=plain[0],
        faces=(*first.faces, *second.faces),
    )
    return [both, *(entry for entry in modifications if entry not in ends)]


def _both(name: str) -> str:
    return name.replace("_non_datum_face", "").replace("_datum_face", "")


def _tip_edge(place: FlankPlace, flank: Part) -> Table:
    """Return the tip chamfer: of the flank, else of the gear's tip form diameter."""
    height = flank.number("tooth_tip_chamfer", "tip_chamfer_mm")
    gear = place.loaded.gear
    form = None if height else gear.number("tip_form_diameter", "tip_chamfer_mm")
    if form:
        height = place.towards_tip * (place.gear.tip_radius - 0.5 * abs(form))
        gear.say("tip_form_diameter", "derived", f"tip_chamfer_mm {height / MM:.6g} = (d_a - d_Fa) / 2")
    if not height or height <= 1e-9:
        return {}
    flank.say("tip_chamfer_angle", "defaulted", "30 deg to the flank")
    return {"tip_chamfer_mm": rounded(height / MM)}


# Flank modifications for which the case has no field, as the nodes of its free-form flank.


_COUNTS = (17, 33, 65, 129)
"""Lines each way: the grid is refined until it differs from the sum of modifications by less than allowed."""
_ALLOWED = 0.05e-6  # m; a tenth of what a gear measuring machine resolves
_SAMPLE = 65
_BETWEEN = 4  # places between two nodes at which the difference is taken


@dataclass(frozen=True)
class _Raster:
    """A free-form flank, its lines, and the largest difference (m) on a grid four times as fine."""

    table: dict[str, Any]
    difference: float
    counts: tuple[int, int]


def _on_grid(place: FlankPlace, modifications: Sequence[Modification], count: int) -> _Raster:
    """Return the raster of a grid of `count` lines in the directions in which the sum varies."""
    rolls, faces = _axes(place, modifications, count)
    removed = _removed(place, modifications, rolls, faces)
    with boundary_errors("flank_grid"):
        grid = FlankGrid(tuple(rolls), tuple(faces), tuple(map(tuple, removed.tolist())))
    table = {
        "roll_length_mm": [rounded(value / MM) for value in rolls],
        "face_position_mm": [rounded(value / MM) for value in faces],
        "removed_um": [[rounded(value / UM) for value in row] for row in removed],
    }
    return _Raster(table, _difference(place, modifications, grid), (len(rolls), len(faces)))


def _axes(
    place: FlankPlace, modifications: Sequence[Modification], count: int
) -> tuple[FloatArray, FloatArray]:
    """Return roll lengths and face positions of the grid, two where the sum does not vary."""
    low, high = sorted((place.root, place.tip))
    half = 0.5 * place.width
    sample = _removed(
        place, modifications, np.linspace(low, high, _SAMPLE), np.linspace(-half, half, _SAMPLE)
    )
    counts = [count if np.ptp(sample, axis=axis).max() > 1e-3 * _ALLOWED else 2 for axis in (0, 1)]
    rolls = [kink for entry in modifications for kink in entry.rolls]
    faces = [place.loaded.datum * (half - kink) for entry in modifications for kink in entry.faces]
    return (
        _through(np.linspace(low, high, counts[0]), rolls),
        _through(np.linspace(-half, half, counts[1]), faces),
    )


def _through(axis: FloatArray, kinks: Sequence[float]) -> FloatArray:
    """Return an axis whose inner nodes next to kinks are moved to them."""
    moved = axis.copy()
    for kink in kinks:
        nearest = int(np.argmin(np.abs(axis - kink)))
        if 0 < nearest < len(axis) - 1:
            moved[nearest] = kink
    return moved


def _difference(place: FlankPlace, modifications: Sequence[Modification], grid: FlankGrid) -> float:
    """Return the largest difference between a grid and what it stands for, m."""
    axes = [_finer(np.array(axis)) for axis in (grid.roll_length, grid.face_position)]
    expected = _removed(place, modifications, *axes)
    rolls, faces = np.meshgrid(*axes, indexing="ij")
    return float(np.abs(grid.material_removed(rolls, faces) - expected).max())


def _finer(axis: FloatArray) -> FloatArray:
    """Return an axis with further places between its nodes."""
    fractions = np.arange(_BETWEEN * (len(axis) - 1) + 1) / _BETWEEN
    return np.interp(fractions, np.arange(len(axis)), axis)


def _removed(
    place: FlankPlace, modifications: Sequence[Modification], rolls: FloatArray, faces: FloatArray
) -> FloatArray:
    """Return the sum of the modifications at roll lengths (m) and face positions (n) of the case, (m, n)."""
    coordinates = 0.5 * place.width - place.loaded.datum * faces
    roll, face = np.meshgrid(rolls, coordinates, indexing="ij")
    return np.asarray(sum(entry.removed(roll, face) for entry in modifications))
