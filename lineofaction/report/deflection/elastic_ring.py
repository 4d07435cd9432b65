"""Elastic ring gear: deflection in the meshes, loads of the planets, modes, lines beside the mesh order."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

from bounds.error_digits import error_text, to_error, with_error
from bounds.types import Json
from lineofaction.gearbox.convert.effects import assumption_lines
from lineofaction.gearbox.convert.operating_point import typed
from lineofaction.gearbox.studies.elastic_ring.run import RUN, ElasticRing
from lineofaction.gearbox.units import DEGREE, UM
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import Axis, Figure, Line, Panel, Table, number
from lineofaction.report.drawing.page import Headline, Page, Part, Section
from lineofaction.report.drawing.tables import settings_table
from lineofaction.report.presentation import Presentation

_CURVES = 4
"""Most loads that are drawn."""
LEAST_LINE = 1e-4
"""Least line of the tables over the largest."""


def _ring_figure(ring: ElasticRing) -> Figure:
    """Draw the deflection over the way from lug to lug, and the largest load of a planet over the torque."""
    loads = sorted({round(k * (ring.torque.size - 1) / (_CURVES - 1)) for k in range(_CURVES)})
    angle, deflection = ring.angle / DEGREE, ring.ring_deflection / UM
    error = ring.ring_deflection_error / UM
    over = tuple(
        Line(
            f"{typed(ring.torque[load])} N m", angle, deflection[load], palette.category(k), band=error[load]
        )
        for k, load in enumerate(loads)
    )
    shares = (
        Line("elastic", ring.torque, ring.share.max(axis=1), palette.BLUE, band=ring.share_error),
        Line("rigid ring", ring.torque, ring.rigid_share.max(axis=1), palette.ORANGE, "dash"),
    )
    return Figure(
        key="elastic_ring",
        title="Deflection of the ring gear and loads of the planets",
        caption="Displacement of the ring along the line of action of a planet as it passes from one lug to "
        "the next, all planets carrying alike; the largest load of a planet over the mean, pins as stated.",
        alternative=_alternative(ring),
        content=(
            Panel(Axis("angle of the planet from a lug, degrees"), Axis("\u00b5m"), over, title="Ring"),
            Panel(Axis("torque on each planet, N m"), Axis("over the mean"), shares, title="Largest load"),
        ),
    )


def _alternative(ring: ElasticRing) -> str:
    last = RUN.figures(ring)["load_cases"][-1]
    return (
        f"At {typed(last['torque_n_m'])} N m the ring gives way by "
        f"{with_error(last['ring_deflection_um'], last['ring_deflection_error_um'])} \u00b5m and varies by "
        f"{with_error(last['ring_ripple_um'], last['ring_ripple_error_um'])} \u00b5m from lug to lug."
    )


def _mesh_deflection(case: Json) -> str:
    deflection, error = case["table_deflection_um"], case["table_deflection_error_um"]
    return number(deflection) if error is None else with_error(deflection, error)


def _load_table(figures: Json) -> Table:
    columns: dict[str, Callable[[Json], str]] = {
        "torque N m": lambda case: typed(case["torque_n_m"]),
        "force N": lambda case: number(case["force_n"], 4),
        "mesh \u00b5m": _mesh_deflection,
        "ring \u00b5m": lambda case: with_error(case["ring_deflection_um"], case["ring_deflection_error_um"]),
        "lug to lug \u00b5m": lambda case: with_error(case["ring_ripple_um"], case["ring_ripple_error_um"]),
        "largest load": lambda case: with_error(max(case["share"]), case["largest_share_error"]),
        "on a rigid ring": lambda case: f"{max(case['share_on_rigid_ring']):.3f}",
    }
    return Table.of("Deflection of the ring in the mesh of a planet", figures["load_cases"], columns)


def _mode_table(figures: Json) -> Table:
    columns: dict[str, Callable[[Json], str]] = {
        "frequency Hz": lambda mode: with_error(mode["frequency_hz"], mode["frequency_error_hz"]),
        "waves": lambda mode: str(mode["waves"]),
        "share %": lambda mode: f"{100.0 * mode['share']:.0f}",
    }
    return Table.of("Modes of the ring on its support", figures["modes"], columns)


def _line_table(figures: Json) -> Table:
    lines = figures["side_lines"]
    largest = max((max(line["radial_n"], line["tangential_n"]) for line in lines), default=0.0)
    seen = [
        line for line in lines if max(line["radial_n"], line["tangential_n"]) > LEAST_LINE * largest > 0.0
    ]

    def size(value: float) -> str:
        return number(value) if value > LEAST_LINE * largest else "0"

    columns: dict[str, Callable[[Json], str]] = {
        "order of the carrier": lambda line: str(line["order"]),
        "radial N": lambda line: size(line["radial_n"]),
        "tangential N": lambda line: size(line["tangential_n"]),
    }
    return Table.of("Force of a lug under mesh order 1, per N in each mesh", seen, columns)


def _series(ring: ElasticRing) -> Table:
    """Return the deflection at every load and angle, with all digits."""
    rows = [
        (repr(float(torque)), repr(float(angle / DEGREE)), repr(float(value / UM)))
        for torque, over in zip(ring.torque, ring.ring_deflection, strict=True)
        for angle, value in zip(ring.angle, over, strict=True)
    ]
    return Table("Deflection of the ring", ("torque_n_m", "angle_deg", "ring_deflection_um"), tuple(rows))


def _left_out(figures: Json) -> str:
    return f"Left out: {'; '.join(figures['left_out'])}."


def _text(ring: ElasticRing) -> Iterator[Table | str]:
    figures = RUN.figures(ring)
    yield _left_out(figures)
    yield _load_table(figures)
    yield _mode_table(figures)
    yield _line_table(figures)
    yield from assumption_lines(figures["receipt"])


def _page(ring: ElasticRing) -> Page:
    figures = RUN.figures(ring)
    last = figures["load_cases"][-1]
    at = f"at {typed(last['torque_n_m'])} N m on a planet"
    mode = figures["modes"][0]
    heads = (
        _headline(
            f"deflection of the ring {at}",
            last["ring_deflection_um"],
            last["ring_deflection_error_um"],
            "\u00b5m",
        ),
        _headline(
            f"largest load of a planet {at}", max(last["share"]), last["largest_share_error"], "of the mean"
        ),
        _headline("lowest mode of the ring", mode["frequency_hz"], mode["frequency_error_hz"], "Hz"),
    )
    tables = (_load_table(figures), _mode_table(figures), _line_table(figures))
    cost = {name: value for name, value in figures["receipt"].items() if name != "plan"}
    sections = (
        Section("Elastic ring gear", _left_out(figures), (_ring_figure(ring),), tables),
        Section("Receipt of the table", tables=(settings_table("Cost", cost),), part=Part.RECEIPT),
    )
    return Page("Elastic ring gear", "", heads, sections)


def _headline(name: str, value: float, error: float, unit: str) -> Headline:
    return Headline(name, f"{to_error(value, error)} {unit}", f"\u00b1 {error_text(value, error)} {unit}")


def _no_point(_ring: Any) -> str:
    return ""  # the tables name their loads


PAGE = Presentation(_ring_figure, _page, _text, series=_series, point=_no_point)
