"""The radiation models of a housing side by side: levels, stated errors, what they cost and would cost."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from dynamics.noise import RadiatedSound
from lineofaction.gearbox.units import RPM
from lineofaction.report.drawing.figure import Table, number
from lineofaction.report.drawing.tables import amount, gigabytes

Json = dict[str, Any]
HEAD = ("model", "level, dB", "stated error, dB", "CPU s", "CPU s predicted", "GB predicted")


def model_tables(sound: RadiatedSound) -> Iterator[Table]:
    """Yield the models of each housing where it is loudest."""
    for housing in sound.housing:
        compared = sound.facts["models"][housing]
        if compared.get("predicted"):
            yield _models(housing, compared)


def _models(housing: str, compared: Json) -> Table:
    """List the models from coarse to fine, those that were not computed with what they would cost."""
    speed = number(compared["speed"] / RPM, 4)
    caption = f"Radiation models of {housing} at order {compared['order']:.4g}, {speed} rpm"
    return Table(caption, HEAD, tuple(_model(name, compared) for name in compared["predicted"]))


def _model(name: str, compared: Json) -> tuple[str, ...]:
    level, spent = compared["level"].get(name), compared["seconds"].get(name)
    low, high = compared["error_band"][name]
    predicted = compared["predicted"][name]
    return (
        name.replace("_", " "),
        "not computed" if level is None else f"{level:.1f}",
        f"{low:+.1f} to {high:+.1f}",
        amount(spent),
        amount(predicted["seconds"]),
        gigabytes(predicted["bytes"]),
    )
