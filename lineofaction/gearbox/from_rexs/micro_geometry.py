"""The modifications of a flank: along the face width, along the profile, and as measured grids."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from bounds import engineering
from fe_contact.geometry import FlankGrid, Toothing
from fe_contact.types import FloatArray
from lineofaction.gearbox.convert.case import boundary_errors
from lineofaction.gearbox.from_rexs.account import Fate
from lineofaction.gearbox.from_rexs.gear_unit import GearUnit, Part
from lineofaction.gearbox.from_rexs.meshing import LoadedFlank
from lineofaction.gearbox.from_rexs.profile_modifications import (
    SCALABLE,
    FlankPlace,
    Modification,
    mm,
    profile_crowning,
    profile_slope,
    relative_depth,
    root_relief,
    shape_of,
    tip_relief,
    two_parabolas,
    um,
)
from lineofaction.gearbox.from_rexs.toothing import required
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.units import MM, UM

# Helix crowning and slope, end reliefs and twist (ISO 21771-1, clauses 7.3 and 7.4).


def helix_crowning(place: FlankPlace, part: Part) -> Modification:
    """Return a helix crowning, a parabola on either side of its highest point; raises `BadInput`."""
    datum = part.number("helix_crowning_amount_datum_face", "helix_crowning_um")
    other = part.number("helix_crowning_amount_non_datum_face", "helix_crowning_um")
    if datum is None and other is None:
        raise BadInput.of(f"{part.place}, helix_crowning_amount_datum_face", None, "given")
    for item, value in (("datum_face", datum), ("non_datum_face", other)):
        if value is None:
            part.say(f"helix_crowning_amount_{item}", "defaulted", "as at the other face")
    amounts = (datum if datum is not None else other or 0.0, other if other is not None else datum or 0.0)
    words = "where the amount is stated"
    first = part.number("coordinate_where_helix_crowning_is_specified_datum_face", words) or 0.0
    last = part.number("coordinate_where_helix_crowning_is_specified_non_datum_face", words)
    ends = (first, place.width if last is None else last)
    highest = part.number("helix_highest_point", "highest point")
    highest = 0.5 * (ends[0] + ends[1]) if highest is None else highest
    if not ends[0] < highest < ends[1]:
        raise BadInput.of(
            f"{part.place}, helix_highest_point", mm(1e3 * highest), "between the stated amounts"
        )
    part.text("shape_of_helix_crowning", "a parabola; an arc is one to (amount / length)^2")
    return Modification(
        part,
        lambda _roll, face: two_parabolas(face, highest, ends, amounts),
        _crowning_fields(place, highest, ends, amounts),
        faces=(highest,),
    )


def _crowning_fields(
    place: FlankPlace, highest: float, ends: tuple[float, float], amounts: tuple[float, float]
) -> dict[str, float]:
    """Return the fields of a helix crowning: one if it is even, else those of both faces."""
    whole = place.same(ends[0], 0.0) and place.same(ends[1], place.width)
    if whole and place.same(highest, 0.5 * place.width) and amounts[0] == amounts[1]:
        return {"helix_crowning_um": um(amounts[0])}
    fields = {}
    faces = (0.0, place.width)
    for datum, face, stated, amount in zip((True, False), faces, ends, amounts, strict=True):
        name = place.face_field("helix_crowning", datum=datum)
        fields[f"{name}_um"] = um(amount * ((face - highest) / (stated - highest)) ** 2)
        fields[f"{name}_length_mm"] = mm(1e3 * abs(face - highest))
    return fields


def helix_slope(place: FlankPlace, part: Part) -> Modification:
    """Return a helix slope: > 0 removes towards the non-datum face, zero at mid-face; raises `BadInput`."""
    amount = required(part, "helix_slope", "helix_slope_um; > 0 removes at the non-datum face")
    whole = amount * place.width / _slope_length(place, part)
    return Modification(
        part,
        lambda _roll, face: whole * (face / place.width - 0.5),
        {"helix_slope_um": um(-place.loaded.datum * whole)},
    )


def _slope_length(place: FlankPlace, part: Part) -> float:
    """Return the length in m over which the amount of a helix slope is stated."""
    reference = part.text("helix_evaluation_reference", "length of the amount")
    flank = place.loaded.flank
    if reference == "facewidth_usable" and flank is not None:
        start, end = (
            flank.number(f"facewidth_usable_{item}", "length of the helix slope") for item in ("start", "end")
        )
    elif reference == "facewidth":
        return place.width
    else:
        start = part.number("helix_evaluation_start", "length of the amount")
        end = part.number("helix_evaluation_end", "length of the amount")
    start, end = start or 0.0, place.width if end is None else end
    if not end > start:
        raise BadInput.of(
            f"{part.place}, helix_evaluation_end", mm(1e3 * end), "above helix_evaluation_start"
        )
    return end - start


def end_relief(place: FlankPlace, part: Part) -> Modification:
    """Return an end relief at one face, datum or non-datum by its type, with the fields of one at both.

    Raises
    ------
    BadInput
        No depth, or a length that does not fit the face.
    """
    side = part.type.removeprefix("end_relief_")
    depth = required(part, f"end_relief_depth_{side}", "end relief")
    length = required(part, f"end_relief_length_{side}", "length of the end relief")
    shape = shape_of(part)
    end = 0.0 if side == "datum_face" else place.width
    inwards = 1.0 if side == "datum_face" else -1.0
    start = end + inwards * length
    stated = part.number(f"end_relief_evaluation_reference_{side}", "where the amount is stated")
    stated = end if stated is None else stated
    if not 0.0 < length <= place.width or not (start - stated) * inwards > 0.0:
        raise BadInput.of(
            f"{part.place}, end_relief_length_{side}", mm(1e3 * length), "above 0, within the face"
        )
    fields: dict[str, Any] = {}
    if shape in SCALABLE or place.same(stated, end):
        at_end = depth * float(relative_depth(shape, np.asarray((end - start) / (stated - start))))
        name = place.face_field("end_relief", datum=side == "datum_face")
        fields = {f"{name}_um": um(at_end), f"{name}_length_mm": mm(1e3 * length), f"{name}_shape": shape}
    return Modification(part, partial(_end, depth, shape, start, stated), fields, faces=(start,))


def _end(
    depth: float, shape: str, start: float, stated: float, _roll: FloatArray, face: FloatArray
) -> FloatArray:
    return depth * relative_depth(shape, (face - start) / (stated - start))


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


def profile_twist(place: FlankPlace, part: Part) -> Modification:
    """Return a twist: the profile slope at the non-datum face less that at the datum face.

    Raises
    ------
    BadInput
        No amount, or no distance between the places that it is stated for.
    """
    amount = required(part, "profile_twist", "flank_twist_um, a quarter of it")
    words = "range of the amount"
    start = place.roll_length(part, "profile_twist_evaluation_start", words)
    end = place.roll_length(part, "diameter_where_profile_twist_amount_is_specified", words)
    end = place.roll_length(part, "profile_twist_evaluation_end", words) if end is None else end
    start, end = (place.root if start is None else start), (place.tip if end is None else end)
    first = part.number("position_of_profile_twist_datum_face", words) or 0.0
    last = part.number("position_of_profile_twist_non_datum_face", words)
    last = place.width if last is None else last
    if not last > first or not (end - start) * place.towards_tip > 0.0:
        raise BadInput.of(
            f"{part.place}, profile_twist", part.name, "stated over a range of profile and face"
        )
    whole = amount * (place.tip - place.root) / (end - start) * place.width / (last - first)
    middle, half = 0.5 * (place.tip + place.root), 0.5 * (place.tip - place.root)
    return Modification(
        part,
        lambda roll, face: (
            0.25 * whole * np.asarray((roll - middle) / half * (2.0 * face / place.width - 1.0))
        ),
        {"flank_twist_um": um(-0.25 * place.loaded.datum * whole)},
    )


# Flank modifications of the loaded flank as fields of a case (ISO 21771-1, clause 7).


# Flank modifications for which the case has no field, as the nodes of its free-form flank.


_COUNTS = (17, 33, 65, 129)
_ALLOWED = 0.05e-6  # m; a tenth of what a gear measuring machine resolves
_SAMPLE = 65
_BETWEEN = 4  # places between two nodes at which the difference is taken


@dataclass(frozen=True)
class Raster:
    """A free-form flank and its largest difference in m from what it stands for."""

    table: dict[str, Any]
    difference: float
    counts: tuple[int, int]


def _rasterized(place: FlankPlace, modifications: Sequence[Modification]) -> Raster:
    """Return the sum of modifications on a grid over the involute and the face.

    The grid is refined until it differs from the sum by less than 0.05 um, or has 129 lines each way. The
    difference is the largest on a grid four times as fine.
    """
    for count in _COUNTS:
        raster = _on_grid(place, modifications, count)
        if raster.difference <= _ALLOWED:
            break
    return raster


def _on_grid(place: FlankPlace, modifications: Sequence[Modification], count: int) -> Raster:
    """Return the raster of a grid of `count` lines in the directions in which the sum varies."""
    rolls, faces = _axes(place, modifications, count)
    removed = _removed(place, modifications, rolls, faces)
    with boundary_errors("flank_grid"):
        grid = FlankGrid(tuple(rolls), tuple(faces), tuple(map(tuple, removed.tolist())))
    table = {
        "roll_length_mm": [mm(value / MM) for value in rolls],
        "face_position_mm": [mm(value / MM) for value in faces],
        "removed_um": [[um(value) for value in row] for row in removed],
    }
    return Raster(table, _difference(place, modifications, grid), (len(rolls), len(faces)))


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


# A flank's topographical modification: amounts at the nodes of a grid.


_AMOUNTS = "topographical_modification_amounts"
_FACES = "coordinates_of_topographical_modification"
_DIAMETERS, _LENGTHS = "diameters_of_topographical_modification", "length_of_topographical_modification"


def _topography(place: FlankPlace, part: Part) -> Modification:
    """Return a topographical modification: an amount for each pair of a coordinate and a diameter.

    The three lists have an entry for each node. Between the nodes the amounts are linear, beyond them those
    of the border.

    Raises
    ------
    BadInput
        Lists of different lengths, nodes that are no grid, or a diameter inside the base circle.
    """
    from scipy.interpolate import RegularGridInterpolator  # noqa: PLC0415 (start-up time)

    amounts = part.numbers(_AMOUNTS, "flank_grid")
    faces = part.numbers(_FACES, "flank_grid, from the datum face")
    rolls = _roll_lengths(place, part)
    if amounts is None or faces is None or rolls is None or not len(amounts) == len(faces) == len(rolls):
        counts = [None if entry is None else len(entry) for entry in (faces, rolls, amounts)]
        raise BadInput.of(f"{part.place}, {_AMOUNTS}", counts, "as many coordinates, diameters and amounts")
    nodes = dict(zip(zip(rolls, faces, strict=True), amounts, strict=True))
    axes = [np.array(sorted({node[axis] for node in nodes})) for axis in (0, 1)]
    if len(nodes) != len(axes[0]) * len(axes[1]) or min(map(len, axes)) < 2 or len(nodes) != len(amounts):
        raise BadInput.of(f"{part.place}, {_AMOUNTS}", len(amounts), "on a grid of coordinates and diameters")
    values = np.array([[nodes[roll, face] for face in axes[1]] for roll in axes[0]])
    surface = RegularGridInterpolator(tuple(axes), values)

    def removed(roll: FloatArray, face: FloatArray) -> FloatArray:
        """Material removed, beyond the grid that of its border."""
        inside = [np.clip(x, axis[0], axis[-1]) for x, axis in zip((roll, face), axes, strict=True)]
        return np.asarray(surface(np.stack(np.broadcast_arrays(*inside), axis=-1)))

    return Modification(part, removed, rolls=tuple(axes[0]), faces=tuple(axes[1]))


def _roll_lengths(place: FlankPlace, part: Part) -> tuple[float, ...] | None:
    """Return the roll lengths in m of the nodes, from their diameters or as such."""
    diameters = part.numbers(_DIAMETERS, "flank_grid, as roll lengths")
    if diameters is None:
        return part.numbers(_LENGTHS, "flank_grid")
    base = place.gear.base_radius
    if min(abs(value) for value in diameters) <= 2.0 * base:
        raise BadInput.of(f"{part.place}, {_DIAMETERS}", 1e3 * min(diameters), f"above {2e3 * base:.7g} mm")
    return tuple(float(np.sqrt((0.5 * value) ** 2 - base**2)) for value in diameters)


Table = dict[str, Any]

READERS: dict[str, Callable[[FlankPlace, Part], Modification]] = {
    "tip_relief": tip_relief,
    "root_relief": root_relief,
    "profile_crowning": profile_crowning,
    "profile_slope": profile_slope,
    "helix_crowning": helix_crowning,
    "helix_slope": helix_slope,
    "end_relief_datum_face": end_relief,
    "end_relief_non_datum_face": end_relief,
    "profile_twist": profile_twist,
    "topographical_modification": _topography,
}
"""What reads each component that modifies a flank."""

_WITHOUT_EXTENT: tuple[Fate, str] = ("refused", "REXS states no extent of it along the face")
_MEASURED: tuple[Fate, str] = ("ignored", "measured deviations are no part of the nominal flank")
UNREAD = {
    "triangular_tip_relief": _WITHOUT_EXTENT,
    "triangular_root_relief": _WITHOUT_EXTENT,
    "profile_deviation": _MEASURED,
    "helix_deviation": _MEASURED,
}
"""What becomes of the components of a flank that nothing here reads."""


def micro_geometry(unit: GearUnit, gear: Toothing, loaded: LoadedFlank) -> Table:
    """Return the fields of the loaded flank's modifications, empty for an involute helicoid.

    What has no field, or a field that another modification takes, is summed on the case's `flank_grid`; the
    account has the grid's largest difference.

    Parameters
    ----------
    gear : Toothing
        The gear without modifications.

    Raises
    ------
    BadInput
        A modification without its amount, or at a place that the flank does not have.
    """
    if loaded.flank is None:
        return {}
    place = FlankPlace(gear, loaded)
    entries = _at_both_ends(place, list(_modifications(unit, place, loaded.flank)))
    fields: Table = _tip_edge(place, loaded.flank)
    rest: list[Modification] = []
    for entry in entries:
        if entry.fields and not set(entry.fields) & set(fields):
            fields |= entry.fields
        else:
            rest.append(entry)
    if rest:
        raster = _rasterized(place, rest)
        fields["flank_grid"] = raster.table
        lines = f"{raster.counts[0]} roll lengths by {raster.counts[1]} face positions"
        words = f"{', '.join(entry.part.name for entry in rest)} on {lines}; differs by at most"
        loaded.flank.say("flank_grid", "derived", f"{words} {engineering(raster.difference / UM, 2)} um")
    return fields


def _modifications(unit: GearUnit, place: FlankPlace, flank: Part) -> Iterator[Modification]:
    """Yield the modifications of a flank; state which are left aside, or read otherwise than written."""
    for part in (*unit.related(flank, "reference", "origin", "referenced"), *unit.children(flank)):
        if part.type in UNREAD:
            part.say("", *UNREAD[part.type])
        if part.type not in READERS:
            continue
        if part.attribute("position_of_profile_modification") is not None:
            part.say(
                "position_of_profile_modification", "ignored", "the profile is the same all over the face"
            )
        additive = part.text("is_additive_modification", "modifications add up")
        if additive == "False":
            part.say("is_additive_modification", "ignored", "modifications add up")
        yield READERS[part.type](place, part)


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
    return {"tip_chamfer_mm": mm(height / MM)}
