"""Lines about a tolerance: drafts during refinement, passes, and the final verdict."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from bounds import engineering
from bounds.types import Json
from lineofaction.gearbox.units import MM, NM, UM

NODES = {
    "misalignment": ("misalignments", UM, "µm"),
    "center_distance_change": ("center distance changes", MM, "mm"),
}


def tolerance_lines(receipt: Json, newton_metre: float = 1.0) -> Iterator[str]:
    """Yield lines on the tolerance: met or why not, and the passes; `newton_metre`: force of 1 N m, N."""
    goal = receipt.get("tolerance")
    if not goal:
        return
    yield _verdict(goal)
    passes = receipt.get("passes", ())
    if len(passes) > 1:
        yield from (_pass(number, entry) for number, entry in enumerate(passes, 1))
    axes = NODES | {"force": ("torques", newton_metre, "N m")}
    for beyond in goal.get("between_nodes", ()):
        name, unit, symbol = axes[beyond["axis"]]
        low, high = (f"{value / unit:.6g}" for value in beyond["between"])
        yield (
            f"between the {name} {low} and {high} {symbol} interpolation errs by "
            f"{engineering(beyond['used'], 2)} times the tolerance: {beyond['limit']}"
        )


def tolerance_warnings(receipt: Json) -> Iterable[Json]:
    """Return one warning where errors were measured and the tolerance is not met."""
    goal = receipt.get("tolerance")
    if not goal or goal["met"] is not False:
        return []
    reason = f" ({goal['reason']})" if goal.get("reason") else ""
    return [{"check": "tolerance", "message": f"{_verdict(goal)}{reason}"}]


def _verdict(goal: Json) -> str:
    tolerance = (
        f"tolerance {engineering(100 * goal['relative'], 3)} % or {engineering(goal['floor_m'] / NM, 3)} nm"
    )
    if goal["met"] is None:
        return f"{tolerance}: errors not estimated"
    numerical = "" if goal["used"] is None else _percent(goal["used"] * goal["relative"], "numerical error")
    lasting = (
        f"{_percent(goal['lasting'], 'of the method')}, which no mesh lowers" if "lasting" in goal else ""
    )
    return f"{tolerance}: {'met' if goal['met'] else 'NOT met'}{numerical}{lasting}"


def _percent(part: float, name: str) -> str:
    return f"; {name} {engineering(100.0 * part, 2)} %"


def _pass(number: int, entry: Json) -> str:
    mesh = entry["level"] if entry["slices"] == 1 else f"{entry['level']}, {entry['slices']} slices"
    used = "failed" if entry["used"] is None else f"used {engineering(entry['used'], 2)}"
    refined = f", refined {', '.join(entry['refined'])}" if entry["refined"] else ""
    return (
        f"pass {number}: {entry['model']}, {mesh}, "
        f"{engineering(entry['cpu_seconds'], 2)} CPU s, {used}{refined}"
    )
