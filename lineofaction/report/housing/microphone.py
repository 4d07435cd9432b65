"""Sound pressure at a microphone: the order of the complaint, and all orders with their bands."""

from __future__ import annotations

import numpy as np

from bounds.types import Json
from lineofaction.report.drawing.figure import Table, number
from lineofaction.report.drawing.marks import order_words
from lineofaction.report.drawing.page import Headline


def pressure_headline(pressure: Json, facts: Json) -> Headline:
    """Say the level of the complaint's order, without one of the loudest, at the microphone."""
    asked_for = facts.get("complaint", {}).get("order", np.nan)
    own = [row for row in pressure["orders"] if np.isclose(row["order"], asked_for, rtol=1e-6)]
    row = own[0] if own else max(pressure["orders"], key=lambda row: row["level_db_a"])
    words = f"order {order_words(row['order'], facts)} at {number(row['speed_rpm'], 4)} rpm"
    if row["low_db_a"] is not None:
        words += f"; {row['low_db_a']:.1f} to {row['high_db_a']:.1f}, the band of its sound power"
    return Headline(f"sound pressure level at {_point(pressure)}", f"{row['level_db_a']:.1f} dB(A)", words)


def _point(pressure: Json) -> str:
    return f"({', '.join(f'{value:g}' for value in pressure['microphone_mm'])}) mm"


def pressure_table(pressure: Json, facts: Json) -> Table:
    """List the orders, each where it is loudest."""
    columns = {
        "order": lambda row: order_words(row["order"], facts),
        "dB(A)": lambda row: f"{row['level_db_a']:.1f}",
        "from": lambda row: "" if row["low_db_a"] is None else f"{row['low_db_a']:.1f}",
        "to": lambda row: "" if row["high_db_a"] is None else f"{row['high_db_a']:.1f}",
        "speed, rpm": lambda row: number(row["speed_rpm"], 5),
    }
    return Table.of(
        f"Largest sound pressure level of each order at {_point(pressure)}", pressure["orders"], columns
    )
