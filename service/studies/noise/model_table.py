"""The radiation models of a housing side by side: levels, stated errors, what they cost and would cost."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from dynamics.noise import RadiatedSound
from service.drawing.figure import Table, number
from service.studies.housing_costs import amount, cost_table, gigabytes
from service.units import RPM

Json = dict[str, Any]
HEAD = ("model", "level, dB", "stated error, dB", "CPU s", "CPU s predicted", "GB predicted")


def model_tables(sound: RadiatedSound) -> Iterator[Table]:
    """Yield the models of each housing where it is loudest, and the cost of the housings."""
    for housing in sound.housing:
        compared = sound.facts["models"][housing]
        if compared.get("predicted"):
            yield _models(housing, compared)
    work = tuple(_work(sound))
    if any(cost is not None for _, cost in work):
        yield cost_table(work)


def _models(housing: str, compared: Json) -> Table:
    """List the models from coarse to fine, those that were not computed with what they would cost."""
    speed = number(compared["speed"] / RPM, 4)
    caption = f"Radiation models of {housing} at order {compared['order']:g}, {speed} rpm"
    return Table(caption, HEAD, tuple(_model(name, compared) for name in compared["predicted"]))


def _model(name: str, compared: Json) -> tuple[str, ...]:
    """Describe a model."""
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


def _work(sound: RadiatedSound) -> Iterator[tuple[str, Json | None]]:
    """Yield the work on each housing and its cost."""
    for housing in sound.housing:
        radiation = sound.facts["radiation"][housing]
        yield f"{housing}: reduction", sound.facts.get("reduction_cost", {}).get(housing)
        model = radiation["model_name"].replace("_", " ")
        yield f"{housing}: {model}, all frequencies", radiation.get("cost")
