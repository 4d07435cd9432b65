"""An accuracy ladder, of a case or of a scene, read back from the JSON that it was stored as."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from dynamics.accuracy import FidelityResult as SceneFidelity
from dynamics.accuracy import Frontier as SceneFrontier
from dynamics.accuracy.frontier import FIGURES
from dynamics.accuracy.vibration import Vibration
from fe_contact.analysis import Frontier
from fe_contact.analysis.accuracy_study.full_contact import FullContactLevel
from fe_contact.analysis.fidelity_result import FidelityResult

Json = dict[str, Any]


def stored_ladder(content: Json) -> Frontier | SceneFrontier:
    """Return the ladder in `content` (`Frontier.to_json` of either library).

    Not stored, and so not in it: what full finite-element contact gave on a case; the orders of the vibration
    that the rungs of a scene were compared to, which are NaN.
    """
    of_case = "solves" in content
    return _of_case(content) if of_case else _of_scene(content)


def _of_case(content: Json) -> Frontier:
    """Return that of a case."""
    names = ("left_out", "solves", "knee", "chosen")
    known = tuple(
        FullContactLevel(level["unknowns"], level["cpu_seconds"] / content["solves"], level["mean_error"])
        for level in content.get("full_finite_element_contact", ())
    )
    rungs = tuple(_rung(rung) for rung in content["rungs"])
    return Frontier(rungs, **{name: content[name] for name in names}, known_full_contact=known)


def _rung(content: Json) -> FidelityResult:
    """One rung; an error that is not known was left out."""
    names = ("name", "title", "stated_error", "cpu_seconds", "stages", "peak_memory_bytes")
    return FidelityResult(
        **{name: content[name] for name in names},
        mean=np.array(content["mean_m"], dtype=float),
        peak_to_peak=np.array(content["peak_to_peak_m"], dtype=float),
        mean_error=content.get("mean_error", math.nan),
        peak_to_peak_error=content.get("peak_to_peak_error", math.nan),
    )


def _of_scene(content: Json) -> SceneFrontier:
    """Return that of a scene."""
    names = ("left_out", "orders", "blocks", "knee", "chosen")
    rms = np.array(content["transmission_error_rms_m"], dtype=float)
    unknown = np.full((*rms.shape, content["orders"]), np.nan)
    return SceneFrontier(
        tuple(_scene_rung(rung) for rung in content["rungs"]),
        reference=Vibration(rms, unknown, unknown[:, :0]),
        **{name: content[name] for name in names},
    )


def _scene_rung(content: Json) -> SceneFidelity:
    """One rung; an error that is not known was left out."""
    rms, orders, forces = (content["errors"].get(name, math.nan) for name in FIGURES)
    names = content["name"], content["title"], content["family"]
    return SceneFidelity(*names, rms, orders, forces, content["cpu_seconds"])
