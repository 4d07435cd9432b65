"""Bands of sound levels by guessed figures, measures that narrow them, and changes for 1 dB."""

from __future__ import annotations

from collections.abc import Iterator

from bounds.types import Json
from lineofaction.report.drawing.figure import Table, number
from lineofaction.report.drawing.marks import order_label

MAX_ORDERS, MAX_CAUSES = 6, 3
MIN_NARROWED = 0.1
"""Least amount in dB by which a measure must narrow a band to be advised."""

NARROWER = {
    "housing_damping": "state the damping of the housing (loss_factor, or measured modal_damping)",
    "housing_frequency": "measure natural frequencies of the housing",
    "mount_stiffness": "measure the stiffness of the mounts",
    "bearing_stiffness": "narrow the stiffness of the bearings",
    "mesh_damping": "narrow the damping of the meshes",
    "mode_number": "keep more modes of the housing",
    "speed_steps": "refine the speeds about the loudest",
    "radiation_model": "correct more lines by boundary elements",
}
"""Measure of the user that narrows a contribution to a band, by contribution."""


def uncertainty_tables(metadata: Json) -> Iterator[Table]:
    """Yield the table of bands and the table of sensitivities, if they are known."""
    if metadata["band"] is not None:
        yield _band_table(metadata["band"], metadata)
    if metadata["sensitivities"]:
        yield _cost_table(metadata["sensitivities"])


def _band_table(band: Json, metadata: Json) -> Table:
    loudest = sorted(band["orders"], key=lambda row: -row["largest"]["level_db_a"])[:MAX_ORDERS]
    levels = [("largest of all orders", band["largest_total"]), ("mean power", band["mean_total"])]
    levels += [(f"largest of order {order_label(row['order'], metadata)}", row["largest"]) for row in loudest]
    columns = {
        "over the speeds": lambda row: row[0],
        "dB(A)": lambda row: f"{row[1]['level_db_a']:.1f}",
        "from": lambda row: f"{row[1]['low_db_a']:.1f}",
        "to": lambda row: f"{row[1]['high_db_a']:.1f}",
        "most by, dB": lambda row: ", ".join(_causes(row[1])),
    }
    return Table.of("Bands over the ranges of what is guessed", levels, columns)


def _causes(level: Json) -> Iterator[str]:
    below, above = level["below_db"], level["above_db"]
    names = sorted(above, key=lambda name: -max(below[name], above[name]))
    for name in names[:MAX_CAUSES]:
        if max(below[name], above[name]) > 0.0:
            yield f"{name.replace('_', ' ')} -{below[name]:.1f} +{above[name]:.1f}"


def narrowest(metadata: Json) -> Iterator[str]:
    """Yield the measure that narrows the band of the largest level most, if any does."""
    # contributions come with the one that leaves the narrowest band first
    level = (metadata["band"] or {}).get("largest_total", {})
    for name, left in level.get("widths_without_db", {}).items():
        if name in NARROWER and level["width_db"] - left >= MIN_NARROWED:
            width = level["width_db"]
            yield f"{NARROWER[name]}: of {width:.1f} dB of the band {left:.1f} are left"
            return


def _cost_table(rows: list[Json]) -> Table:
    """List changes of the largest level by steps, the largest change first."""
    caption = "What 1 dB costs: largest level of all orders; factors are on what the scene states"
    columns = {
        "figure": lambda row: str(row["figure"]),
        "value": lambda row: f"{number(row['value'], 4)}{_unit(row)}",
        "step": lambda row: f"{number(row['step'], 3)}{_unit(row)}",
        "change, dB": lambda row: f"{row['change_db']:+.2f}",
        "two steps, dB": lambda row: f"{row['change_of_two_steps_db']:+.2f}",
        "for -1 dB about": _needed,
        "linear within": lambda row: (
            "any" if row["linear_range"] is None else f"{number(row['linear_range'], 2)}{_unit(row)}"
        ),
    }
    return Table.of(caption, rows, columns)


def _unit(row: Json) -> str:
    return f" {row['unit'].replace('um', 'µm')}" if row["unit"] else ""


def _needed(row: Json) -> str:
    if row["for_one_db_less"] is None:
        return "nothing does"
    beyond = "" if row["linear"] else " (beyond the linear range)"
    return f"{row['for_one_db_less']:+.3g}{_unit(row)}{beyond}"


def ends(level: Json) -> str:
    """Return the ends of a level's band as text."""
    return f"{level['low_db_a']:.1f} to {level['high_db_a']:.1f}"
