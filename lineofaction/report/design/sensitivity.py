"""Peak-to-peak transmission error over misalignment and center distance, in per cent and in micrometers."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

from bounds import engineering
from bounds.error_digits import NO_CHANGE, change_text, error_text, to_error
from fe_contact.analysis.studies.sensitivity import RippleCurve, Sensitivity
from lineofaction.gearbox.convert.operating_point import typed
from lineofaction.gearbox.studies.sensitivity.run import PairStudy
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import Axis, Dash, Figure, FloatArray, Line, Panel, Table
from lineofaction.report.drawing.page import Headline, Page, Section
from lineofaction.report.presentation import Presentation

_MISALIGNMENT = Axis("misalignment over the common face width, µm")
_DISTANCE = Axis("change of the center distance, %")
_PER_CENT, _MICROMETRES = Axis("change of peak to peak, %"), Axis("peak to peak, µm")
_HEAD = ("pair", "corner contact", "deviation", "peak to peak, µm", "error, µm", "change, %")

Curve = tuple[FloatArray, RippleCurve]
SAME = 0.02
"""Change of the contact ratio that 64 positions do not tell from none."""


def _sensitivity_figure(studies: Sequence[PairStudy]) -> Figure:
    """Draw one line per pair, solid with corner contact, dashed without, as Palermo et al. (2010), Fig. 7."""
    return Figure(
        key="sensitivity",
        title="Sensitivity of the transmission error to misalignment and center distance",
        caption="Peak-to-peak static transmission error against the aligned pair's, and in micrometers: per "
        "cents of a small ripple grow large. Dashed: contact ends where plain involutes leave each other.",
        alternative=_alternative(studies),
        content=(
            *_panels(studies, "Misalignment", _MISALIGNMENT, _over_misalignment),
            *_panels(studies, "Center distance", _DISTANCE, _over_distance),
        ),
        table=_sensitivity_table(studies),
    )


def _sensitivity_table(studies: Sequence[PairStudy]) -> Table:
    rows = []
    for study in studies:
        for curves in study.curves:
            corner_contact = "on" if curves.corner_contact else "off"
            by_deviation = _rows(_over_misalignment(study, curves), "misalignment {} µm")
            by_deviation += _rows(_over_distance(study, curves), "center distance {} %")
            rows += [(study.name, corner_contact, *row) for row in by_deviation]
    return Table("Peak-to-peak transmission error", _HEAD, tuple(rows))


def _over_misalignment(_study: PairStudy, curves: Sensitivity) -> Curve:
    return 1e6 * curves.misalignment.deviation, curves.misalignment


def _over_distance(study: PairStudy, curves: Sensitivity) -> Curve:
    change = curves.center_distance_change
    return 100.0 * change.deviation / study.center_distance, change


def _panels(
    studies: Sequence[PairStudy], title: str, x: Axis, curve_of: Callable[[PairStudy, Sensitivity], Curve]
) -> tuple[Panel, Panel]:
    """Draw one panel in per cent and one in micrometers over the same deviation."""
    relative, absolute = [], []
    for index, study in enumerate(studies):
        for curves in study.curves:
            at, curve = curve_of(study, curves)
            name = f"{study.name}, {'with' if curves.corner_contact else 'without'} corner contact"
            dash: Dash = "solid" if curves.corner_contact else "dash"
            color = palette.category(index)
            relative.append(Line(name, at, 100.0 * curve.relative_change, color, dash))
            absolute.append(Line(name, at, 1e6 * curve.peak_to_peak, color, dash))
    return Panel(x, _PER_CENT, tuple(relative), title=title), Panel(x, _MICROMETRES, tuple(absolute))


def _rows(curve: Curve, label: str) -> list[tuple[str, ...]]:
    at, ripple = curve
    changes = 100.0 * ripple.relative_change, 100.0 * ripple.change_error
    columns = (1e6 * ripple.peak_to_peak, 1e6 * ripple.error, *changes)
    rows: list[tuple[str, ...]] = []
    for x, size, error, change, band in zip(at, *columns, strict=True):
        deviation = label.format(f"{round(float(x), 9):g}")
        texts = (to_error(size, error), error_text(size, error), change_text(change, band))
        rows.append((deviation, *texts))
    return rows


def _alternative(studies: Sequence[PairStudy]) -> str:
    parts = []
    for study in studies:
        for curves in study.curves:
            skew = _largest_change(curves.misalignment)
            distance = _largest_change(curves.center_distance_change)
            preposition = "with" if curves.corner_contact else "without"
            parts.append(f"{study.name} {preposition} corner contact {skew} and {distance}")
    return f"Largest change with misalignment and with center distance: {'; '.join(parts)}."


def _largest_change(curve: RippleCurve) -> str:
    return _change(curve, int(abs(curve.relative_change).argmax()))


def _change(curve: RippleCurve, index: int) -> str:
    change, error = 100.0 * float(curve.relative_change[index]), 100.0 * float(curve.change_error[index])
    text = change_text(change, error)
    return text if text == NO_CHANGE else f"{text} %"


def _reasons(studies: Sequence[PairStudy]) -> list[str]:
    """Return why the center distance changes the ripple where it changes most; equal reasons stand once."""
    lines = []
    for study in studies:
        models: dict[str, list[str]] = {}
        for curves in study.curves:
            preposition = "with" if curves.corner_contact else "without"
            models.setdefault(_reason(study, curves), []).append(preposition)
        for reason, prepositions in models.items():
            model = f"{' and '.join(prepositions)} corner contact"
            name = f"{study.name} {model}" if len(studies) > 1 else f"{model[0].upper()}{model[1:]}"
            lines.append(f"{name}: {reason}")
    return lines


def _reason(study: PairStudy, curves: Sensitivity) -> str:
    at, curve = _over_distance(study, curves)
    maximum = int(abs(curve.relative_change).argmax())
    change = float(curve.relative_change[maximum])
    before, after = float(curve.carrying[curve.deviation == 0.0][0]), float(curve.carrying[maximum])
    deviation = f"{round(float(at[maximum]), 9):+g} % of center distance"
    size = _change(curve, maximum)
    if size == NO_CHANGE:
        return f"{deviation} changes the ripple by less than the errors of both."
    verb = "lowers" if change < 0.0 else "raises"
    return f"{deviation} {verb} the ripple by {size[1:]}, {_by_pairs(before, after, change)}."


def _by_pairs(before: float, after: float, change: float) -> str:
    """Return a sentence on the effect of the number of carrying pairs on a relative change of the ripple.

    The ripple is the step between n and n + 1 pairs. It falls as the part that n pairs carry alone shrinks.
    """
    if abs(after - before) < SAME:
        return f"though the contact ratio under load stays at {before:.2f}: the shape of the curve changes"
    moves = "rises" if after > before else "falls"
    way = f"the contact ratio under load {moves} from {before:.2f} to {after:.2f}"
    if (after > before) != (change < 0.0):
        return f"though {way}"
    minimum = min(math.floor(before), math.floor(after))
    alone = "one pair alone carries" if minimum == 1 else f"{minimum} pairs alone carry"
    old, new = (100.0 * max(minimum + 1 - value, 0.0) for value in (before, after))
    where = f"over {new:.0f} % of a base pitch" if new else "nowhere on a base pitch"
    return f"since {way}: {alone} {where} in place of {old:.0f} %"


def _page(studies: Sequence[PairStudy]) -> Page:
    text = " ".join(_reasons(studies))
    section = Section("Sensitivity", text=text, figures=(_sensitivity_figure(studies),))
    headlines = (
        _largest("misalignment", "µm", studies, _over_misalignment),
        _largest("center distance", "%", studies, _over_distance),
    )
    return Page("Sensitivity of gear pairs", "", headlines, (section,))


def _largest(
    over: str, unit: str, studies: Sequence[PairStudy], curve_of: Callable[[PairStudy, Sensitivity], Curve]
) -> Headline:
    curves = [(study, *curve_of(study, curves)) for study in studies for curves in study.curves]
    study, at, curve = max(curves, key=lambda entry: float(entry[2].peak_to_peak.max()))
    k = int(curve.peak_to_peak.argmax())
    ripple, error = 1e6 * float(curve.peak_to_peak[k]), 1e6 * float(curve.error[k])
    change = _change(curve, k)
    against = f"{change} {'from' if change == NO_CHANGE else 'of'} the undeviated pair's"
    name = f", {study.name}" if len(studies) > 1 else ""
    where = f"{round(float(at[k]), 9):g} {unit}, {_load(study)}{name}: {against}"
    band = f"± {error_text(ripple, error)} µm at {where}"
    return Headline(f"largest peak-to-peak STE over {over}", f"{to_error(ripple, error)} µm", band)


def _point(studies: Sequence[PairStudy]) -> str:
    """Return the load of the curves, with the name of the pair where there are several."""
    points = [_load(study) for study in studies]
    if len(studies) > 1:
        points = [f"{load} of {study.name}" for load, study in zip(points, studies, strict=True)]
    return f"at {', '.join(points)}; misalignment and center distance one at a time"


def _load(study: PairStudy) -> str:
    force = f"{engineering(study.normal_force, 4)} N"
    return force if math.isnan(study.torque) else f"{typed(study.torque)} N m ({force})"


PAGE = Presentation(
    _sensitivity_figure,
    _page,
    lambda studies: (_sensitivity_table(studies), *_reasons(studies)),
    series=_sensitivity_table,
    point=_point,
)
