"""Pages that compare two STE databases, or one with a measured transmission error.

A table is an STE database: curves of the STE over the position by torque, misalignment and change of the
center distance. Curves are compared at the misalignment and center distance nearest to nominal. A ripple is a
curve less its mean.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from bounds.error_digits import with_error
from fe_contact.ste import Curve, SteDatabase
from fe_contact.types import Estimate, FloatArray
from lineofaction.gearbox.problems import BadInput
from lineofaction.report.comparison.measured import (
    COLORS,
    PER_PITCH,
    Aligned,
    Difference,
    MeasuredCurve,
    MeasuredOrders,
    aligned_to,
    changed_fields,
    differences_table,
)
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import Axis, Figure, Line, Panel, Table, number, ripple_panel
from lineofaction.report.drawing.page import Headline, Page, Section
from lineofaction.report.pair import pair_title
from lineofaction.report.ste.curves import aligned, um_of

HARMONICS = 3
"""Mesh harmonics in the table of differences."""
MAX_HARMONICS = 8
"""Mesh harmonics in the figure of harmonics."""
_UM = 1e6
"""Micrometers per meter."""
_MARKER_OFFSET = 0.16
"""Distance in orders between the markers of two tables at one harmonic; both lie about the harmonic."""
_TORQUE_ROUNDING = 1e-9
"""Relative rounding by which the ends of two torque ranges may differ."""

Named = dict[str, SteDatabase]
"""One or two tables by the names of their curves, in the sequence of the call."""


def compare_tables(
    tables: Named, measured: MeasuredCurve | MeasuredOrders | None, torque: float | None = None
) -> Page:
    """Return the page that compares two tables with each other, or one with a measurement.

    Ripples and harmonics are drawn at `torque` on the driving gear, N m; None takes the middle one of the
    torques that all tables cover. Raises `BadInput` if the tables have no torque in common, if one does not
    cover `torque`, or if measured orders are not in micrometers.
    """
    torques = _common(tuple(tables.values()))
    ripple_torque = torques[len(torques) // 2] if torque is None else _covered(torque, tables)
    curves = {load: _curves(tables, load) for load in torques}
    differences = tuple(_differences(curves))
    orders = measured if isinstance(measured, MeasuredOrders) else None
    figures = [
        _ripples(
            _curves(tables, ripple_torque),
            ripple_torque,
            measured if isinstance(measured, MeasuredCurve) else None,
        ),
        *([_over_torque(curves)] if len(torques) > 1 else []),
        _harmonics(_curves(tables, ripple_torque), ripple_torque, orders),
    ]
    difference_tables = (differences_table(differences, tuple(tables)),) if differences else ()
    sections = [Section("Transmission errors", figures=tuple(figures), tables=difference_tables)]
    case_fields = changed_fields({name: table.metadata.case for name, table in tables.items()})
    if case_fields.rows:
        sections.append(Section("Cases", tables=(case_fields,)))
    headlines = tuple(
        Headline(f"{difference.name} at {difference.where}", difference.written, difference.finding)
        for difference in differences
        if difference.name == "peak to peak"
    )
    titles = dict.fromkeys(pair_title(table.geometry) for table in tables.values())
    return Page(f"{' and '.join(tables)} compared", "; ".join(titles), headlines, tuple(sections))


def _common(tables: Sequence[SteDatabase]) -> list[float]:
    """Return the torques of the first table that all tables cover, clipped to the ends of that range."""
    low, high = _limits(tables)
    lowest, highest = low * (1 - _TORQUE_ROUNDING), high * (1 + _TORQUE_ROUNDING)
    torques = [float(torque) for torque in tables[0].torque if lowest <= torque <= highest]
    if not torques:
        covered = f"{tables[0].torque[0]:g} to {tables[0].torque[-1]:g} N m of the first"
        bound = f"within {tables[-1].torque[0]:g} to {tables[-1].torque[-1]:g} N m of the second"
        raise BadInput.of("torques", covered, bound, "Compute both for the same torques.")
    return [min(max(torque, low), high) for torque in torques]


def _limits(tables: Sequence[SteDatabase]) -> tuple[float, float]:
    """Return the ends of the range of torques that all tables cover, N m."""
    low = max(float(table.torque[0]) for table in tables)
    return low, min(float(table.torque[-1]) for table in tables)


def _covered(torque: float, tables: Named) -> float:
    low, high = _limits(tuple(tables.values()))
    if not low <= torque <= high:
        raise BadInput.of("--torque", torque, f"{low:g} to {high:g} N m, which all tables hold")
    return torque


def _curves(tables: Named, torque: float) -> dict[str, Curve]:
    """Return the curves of the tables at a torque, at `PER_PITCH` equal steps of a base pitch."""
    positions = np.arange(PER_PITCH) / PER_PITCH
    curves = {}
    for name, table in tables.items():
        misalignment, change = aligned(table)
        curves[name] = table.curve(
            torque=torque, at=positions, misalignment=misalignment, center_distance_change=change
        )
    return curves


def _ripple(curve: Curve) -> FloatArray:
    """Return a curve less its mean, µm."""
    return np.asarray(_UM * (curve.ste - curve.ste.mean()))


def _differences(curves: dict[float, dict[str, Curve]]) -> Iterator[Difference]:
    """Yield the differences of two tables by torque; none for a single table."""
    for torque, by_name in curves.items():
        if len(by_name) < 2:
            return
        first, second = by_name.values()
        where = f"{torque:g} N m"
        yield Difference("mean", where, _um(first.mean), _um(second.mean))
        yield _peak_to_peak(by_name, torque)
        for order in range(HARMONICS):
            yield Difference(
                f"mesh harmonic {order + 1}", where, _um(first.harmonics[order]), _um(second.harmonics[order])
            )


def _peak_to_peak(curves: dict[str, Curve], torque: float) -> Difference:
    first, second = (_um(curve.peak_to_peak) for curve in curves.values())
    return Difference("peak to peak", f"{torque:g} N m", first, second)


def _um(estimate: Estimate) -> Estimate:
    return Estimate(_UM * estimate.value, _UM * estimate.error, "µm")


def _ripples(curves: dict[str, Curve], torque: float, measured: MeasuredCurve | None) -> Figure:
    position = np.arange(2 * PER_PITCH + 1) / PER_PITCH  # two base pitches, both ends included
    lines = [
        Line(name, position, _two_pitches(_ripple(curve)), color, band=0.5 * _UM * curve.peak_to_peak.error)
        for (name, curve), color in zip(curves.items(), COLORS, strict=False)  # more colors than curves
    ]
    caption = "STE less its mean. Bands: half the error of peak-to-peak on either side."
    findings = [f"Peak to peak: {_peak_to_peak(curves, torque)}."] if len(curves) == 2 else []
    if measured is not None:
        name = next(iter(curves))
        match = aligned_to(measured, _ripple(curves[name]))
        lines.append(
            Line("measured", position, _two_pitches(match.ripple), palette.INK, "dash", band=measured.spread)
        )
        caption += (
            f" Measured: mean of {measured.pitches} base pitches, less its mean, moved by {match.shift:.3f} "
            "base pitches to where it is most like the first curve. Its band is the standard deviation of "
            "single base pitches."
        )
        findings.append(_agreement(name, curves[name], match))
    across = Axis("position of the driving gear, base pitches", limits=(0.0, 2.0))
    return Figure(
        key="ripples",
        title=f"Ripple at {torque:g} N m",
        caption=caption,
        alternative=" ".join(findings),
        content=(Panel(across, Axis("STE less its mean, µm"), tuple(lines)),),
    )


def _two_pitches(ripple: FloatArray) -> FloatArray:
    """Return a ripple over two base pitches, closed by its first value."""
    return np.concatenate([ripple, ripple, ripple[:1]])


def _agreement(name: str, curve: Curve, match: Aligned) -> str:
    computed, ripple_measured = _um(curve.peak_to_peak), float(np.ptp(match.ripple))
    return (
        f"Measured {number(ripple_measured, 3)} µm peak to peak, {name} "
        f"{with_error(computed.value, computed.error, 'µm')}; {number(match.rms, 2)} µm rms between them, "
        f"correlation {match.correlation:.2f}."
    )


def _over_torque(curves: dict[float, dict[str, Curve]]) -> Figure:
    torque = np.array(list(curves))
    names = tuple(next(iter(curves.values())))
    lines = []
    for name, color in zip(names, COLORS, strict=False):
        value, error = um_of([by_name[name].peak_to_peak for by_name in curves.values()])
        lines.append(Line(name, torque, value, color, markers=True, band=error))
    return Figure(
        key="ripple_over_torque",
        title="Peak-to-peak STE over torque",
        caption="Bands: the errors.",
        alternative=_significant_torques(curves) if len(names) == 2 else "",
        content=(ripple_panel(Axis("torque on the driving gear, N m"), tuple(lines)),),
    )


def _significant_torques(curves: dict[float, dict[str, Curve]]) -> str:
    differences = [_peak_to_peak(by_name, torque) for torque, by_name in curves.items()]
    significant = [difference for difference in differences if difference.is_significant]
    where = f": {', '.join(difference.where for difference in significant)}" if significant else ""
    return (
        f"The difference is larger than its error at {len(significant)} of {len(curves)} torques{where}. "
        "Its error is the root of the sum of both errors squared."
    )


def _harmonics(curves: dict[str, Curve], torque: float, orders: MeasuredOrders | None) -> Figure:
    order = np.arange(1.0, MAX_HARMONICS + 1.0)
    lines, columns = [], {}
    for index, (name, curve) in enumerate(curves.items()):
        amplitudes = [_um(amplitude) for amplitude in curve.harmonics[:MAX_HARMONICS]]
        value = np.array([amplitude.value for amplitude in amplitudes])
        abscissa = order + _MARKER_OFFSET * index - 0.5 * _MARKER_OFFSET
        lines.append(Line(name, abscissa, value, COLORS[index], width=0.0, markers=True))
        columns[f"{name}, µm"] = [with_error(amplitude.value, amplitude.error) for amplitude in amplitudes]
    caption = "Amplitudes of the mesh harmonics of STE."
    if orders is not None:
        orders.require("µm")
        drawn = orders.order <= MAX_HARMONICS + 0.5  # half an order beyond the last harmonic
        lines.append(Line("measured", orders.order[drawn], orders.amplitude[drawn], palette.INK, width=1.2))
        columns["measured, µm"] = [number(orders.near(float(k)), 3) for k in order]
        caption += " Measured: as read; the table has its largest line within a tenth of each order."
    # A row is a harmonic and its cell of every column.
    rows = tuple((f"{k:g}", *cells) for k, *cells in zip(order, *columns.values(), strict=True))
    largest = [f"harmonic {_largest_harmonic(curve)} of {name}" for name, curve in curves.items()]
    return Figure(
        key="harmonics",
        title=f"Mesh harmonics at {torque:g} N m",
        caption=caption,
        alternative=f"Largest: {', '.join(largest)}.",
        content=(Panel(Axis("mesh order"), Axis("amplitude, µm"), tuple(lines)),),
        table=Table("Mesh harmonics", ("mesh harmonic", *columns), rows),
    )


def _largest_harmonic(curve: Curve) -> int:
    return int(np.argmax([amplitude.value for amplitude in curve.harmonics])) + 1
