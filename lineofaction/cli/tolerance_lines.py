"""Lines of `loa analyze` about a tolerance: drafts while it refines, its passes, and whether it is met."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator
from typing import Any

from bounds import engineering
from fe_contact.ste import SteDatabase
from lineofaction.gearbox.convert.drafts import draft_line
from lineofaction.gearbox.units import MM, NM, UM

Json = dict[str, Any]
_AXES = {
    "force": ("loads", 1.0, "N"),
    "misalignment": ("misalignments", UM, "um"),
    "center_distance_change": ("center distance changes", MM, "mm"),
}


def print_draft(table: SteDatabase, refining: str) -> None:
    """Print the figures of a table that is being refined, on standard error: they are progress."""
    sys.stderr.write(f"{draft_line(table, refining)}\n")
    sys.stderr.flush()


def tolerance_lines(receipt: Json) -> Iterator[str]:
    """Yield whether the tolerance is met by the errors as measured, why not, and the passes if several."""
    kept = receipt.get("tolerance")
    if not kept:
        return
    yield _verdict(kept)
    passes = receipt.get("passes", ())
    if len(passes) > 1:
        yield from (_pass(number, entry) for number, entry in enumerate(passes, 1))
    for beyond in kept.get("between_nodes", ()):
        name, unit, symbol = _AXES[beyond["axis"]]
        low, high = (f"{value / unit:.6g}" for value in beyond["between"])
        yield (
            f"between the {name} {low} and {high} {symbol} "
            f"interpolation uses {engineering(beyond['used'], 2)} of it: "
            "add a value there"
        )


def tolerance_warnings(receipt: Json) -> Iterable[Json]:
    """Return one warning where errors were measured and the tolerance is not met."""
    kept = receipt.get("tolerance")
    if not kept or kept["met"] is not False:
        return []
    reason = f" ({kept['reason']})" if kept.get("reason") else ""
    return [{"check": "tolerance", "message": f"{_verdict(kept)}{reason}"}]


def _verdict(kept: Json) -> str:
    """Return whether the tolerance is met."""
    tolerance = (
        f"tolerance {engineering(100 * kept['relative'], 3)} % or {engineering(kept['floor_m'] / NM, 3)} nm"
    )
    if kept["met"] is None:
        return f"{tolerance}: errors not estimated"
    share = "" if kept["used"] is None else f", largest error {engineering(kept['used'], 2)} of it"
    return f"{tolerance}: {'met' if kept['met'] else 'NOT met'}{share}"


def _pass(number: int, entry: Json) -> str:
    """Return what one pass ran, cost and used."""
    mesh = entry["level"] if entry["slices"] == 1 else f"{entry['level']}, {entry['slices']} slices"
    used = "failed" if entry["used"] is None else f"used {engineering(entry['used'], 2)}"
    refined = f", refined {', '.join(entry['refined'])}" if entry["refined"] else ""
    return (
        f"pass {number}: {entry['model']}, {mesh}, "
        f"{engineering(entry['cpu_seconds'], 2)} CPU s, {used}{refined}"
    )
