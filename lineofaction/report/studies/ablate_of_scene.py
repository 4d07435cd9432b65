"""The change by every effect of a scene, beside its estimate."""

from __future__ import annotations

import numpy as np

from bounds import engineering
from dynamics.ablation import Ablation, EffectAblation
from lineofaction.report.drawing.figure import FloatArray, Panel, Table, number
from lineofaction.report.studies.ablate_look import Look, over_orders

_HEAD = (
    "effect", "scene has it", "influence, µm", "mean DTE, µm", "estimated", "peak to peak, µm", "estimated",
    "order 1, µm", "bearing force, N", "estimated", "of order", "cost, x",
)  # fmt: skip


def _table(ablation: Ablation) -> Table:
    """Return the largest changes over meshes and bearings."""
    caption = (
        "What leaving an effect out changes, second half of the run, the mesh or bearing with the largest"
    )
    return Table(caption, _HEAD, tuple(_row(entry) for entry in LOOK.ordered(ablation)))


def _row(entry: EffectAblation) -> tuple[str, ...]:
    estimate = entry.estimate
    return (
        entry.name,
        "on" if entry.on else "off",
        number(1e6 * entry.influence, 3),
        _signed(1e6 * _most(entry.mean_change)),
        "" if estimate is None else _signed(1e6 * _most(estimate.mean)),
        _signed(1e6 * _most(entry.peak_to_peak_change)),
        "" if estimate is None else _signed(1e6 * _most(estimate.peak_to_peak)),
        _signed(1e6 * _most(entry.order_change[:, 0])),
        *_bearing_force(entry),
        number(entry.cost_ratio, 3),
    )


def _bearing_force(entry: EffectAblation) -> tuple[str, str, str]:
    """Return the largest change of an order of a bearing force, N, its estimate and the order."""
    forces, estimate = entry.bearing_order_change, entry.estimate
    if not forces.size:
        return "", "", ""
    bearing, order = np.unravel_index(int(np.argmax(np.abs(forces))), forces.shape)
    known = estimate is not None and estimate.bearing_orders.size > 0
    stated = _signed(float(estimate.bearing_orders[bearing, order])) if estimate and known else ""
    return _signed(float(forces[bearing, order])), stated, str(order + 1)


def _panels(ablation: Ablation) -> tuple[Panel, ...]:
    """Draw mesh orders of transmission error and bearing force."""
    error = over_orders(
        ablation, lambda figures: np.max(figures.orders, axis=0), "Transmission error", "amplitude, µm", 1e6
    )
    if not ablation.bearing:
        return (error,)
    force = over_orders(
        ablation, lambda figures: np.max(figures.bearing_orders, axis=0), "Bearing force", "amplitude, N", 1.0
    )
    return error, force


def _most(values: FloatArray) -> float:
    return float(values[np.argmax(np.abs(values))])


def _signed(value: float) -> str:
    """Write three digits with a sign; nothing is 0."""
    return "0" if abs(value) < 5e-7 else engineering(value, 3, "+")


LOOK = Look(
    what="scene",
    title="Influence of every effect in this scene",
    change=lambda _ablation, entry: _most(entry.peak_to_peak_change),
    signed=_signed,
    caption=lambda _ablation: (
        "Each effect toggled by itself in all its parts: largest amplitude of every mesh order "
        "over meshes, bearings and the second half of the run. States without any are not drawn."
    ),
    panels=_panels,
    table=_table,
)
