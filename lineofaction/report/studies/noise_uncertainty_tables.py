"""Tables of the bands of a sound, and of what 1 dB costs."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from lineofaction.report.drawing.figure import Table, number

Json = dict[str, Any]
SHOWN_ORDERS, SHOWN_CAUSES = 6, 3
BAND_HEAD = ("largest over the speeds", "dB(A)", "from", "to", "most by, dB")
COST_HEAD = ("figure", "value", "step", "change, dB", "two steps, dB", "for -1 dB about", "linear within")


def uncertainty_tables(facts: Json) -> Iterator[Table]:
    """Yield the tables of what was computed."""
    if facts["band"] is not None:
        yield band_table(facts["band"])
    if facts["sensitivities"]:
        yield cost_table(facts["sensitivities"])


def band_table(band: Json) -> Table:
    """List the bands of the total and of the loudest orders."""
    loudest = sorted(band["orders"], key=lambda row: -row["largest"]["level_db_a"])[:SHOWN_ORDERS]
    rows = [("all orders", band["largest_total"])]
    rows += [(f"order {row['order']:.4g}", row["largest"]) for row in loudest]
    return Table("Bands over the ranges of what is guessed", BAND_HEAD, tuple(_row(*row) for row in rows))


def _row(name: str, level: Json) -> tuple[str, ...]:
    """Describe a band and its largest contributions."""
    ends = (level[key] for key in ("level_db_a", "low_db_a", "high_db_a"))
    return (name, *(f"{end:.1f}" for end in ends), ", ".join(_causes(level)))


def _causes(level: Json) -> Iterator[str]:
    """Yield the contributions that widen a band most."""
    below, above = level["below_db"], level["above_db"]
    names = sorted(above, key=lambda name: -max(below[name], above[name]))
    for name in names[:SHOWN_CAUSES]:
        if max(below[name], above[name]) > 0.0:
            yield f"{name.replace('_', ' ')} -{below[name]:.1f} +{above[name]:.1f}"


def cost_table(rows: list[Json]) -> Table:
    """List what steps change of the largest level, the largest change first."""
    caption = "What 1 dB costs: largest level of all orders; factors are on what the scene states"
    return Table(caption, COST_HEAD, tuple(_cost(row) for row in rows))


def _cost(row: Json) -> tuple[str, ...]:
    """Describe a sensitivity."""
    unit = f" {row['unit'].replace('um', 'µm')}" if row["unit"] else ""
    needed, reach = row["for_one_db_less"], row["linear_range"]
    beyond = "" if row["linear"] else " (beyond the linear range)"
    return (
        row["figure"],
        f"{number(row['value'], 4)}{unit}",
        f"{number(row['step'], 3)}{unit}",
        f"{row['change_db']:+.2f}",
        f"{row['change_of_two_steps_db']:+.2f}",
        "nothing does" if needed is None else f"{needed:+.3g}{unit}{beyond}",
        "any" if reach is None else f"{number(reach, 2)}{unit}",
    )
