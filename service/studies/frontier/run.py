"""Accuracy study of a case or a scene."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from dynamics.accuracy import FidelityResult as SceneFidelity
from dynamics.accuracy import Frontier as SceneFrontier
from dynamics.accuracy import frontier as frontier_of_scene
from dynamics.accuracy.frontier import FIGURES
from dynamics.accuracy.registry import FIDELITIES as SCENE_FIDELITIES
from dynamics.accuracy.vibration import Vibration
from dynamics.scene import Scene
from fe_contact.analysis.accuracy_study import FIDELITIES
from fe_contact.analysis.accuracy_study.full_contact import FullContactLevel
from fe_contact.analysis.fidelity_result import FidelityResult
from fe_contact.analysis.frontier import Frontier, frontier
from service.convert.case import boundary_errors, gear_pair, study_options, table_axes
from service.convert.checks import check_case
from service.problems import BadInput
from service.schemas import Case
from service.schemas.scene import SceneInput
from service.studies.computation import Computation, Means
from service.studies.frontier import Inputs

Json = dict[str, Any]
LEAST = 2


def frontier_of(subject: Case | Scene, inputs: Inputs, means: Means) -> Frontier | SceneFrontier:
    """Study the accuracy of a case, over all pitches that differ and with the whole receipt, or of a scene.

    Raises
    ------
    BadInput
        No such pair or rung, or the run is too short.
    JobFailed
        Fewer than two rungs came to their end.
    """
    rungs = rungs_asked(inputs.rungs, of_scene=isinstance(subject, Scene))
    with boundary_errors():
        if isinstance(subject, Scene):
            return frontier_of_scene(subject, fidelities=rungs, progress=means.report)
        axes = replace(table_axes(subject), pitches=None)
        return frontier(
            gear_pair(subject),
            axes,
            study_options(subject),
            fidelities=rungs,
            full_contact=inputs.full_contact,
            progress=means.report,
        )


def check(subject: Case | SceneInput, inputs: Inputs) -> None:
    """Refuse a case that cannot be, a rung that there is not, and full contact of a scene."""
    if isinstance(subject, Case):
        check_case(subject)
    elif inputs.full_contact is not None:
        raise BadInput.of("full_contact", inputs.full_contact, "left out for a scene", "Give it with a case.")
    rungs_asked(inputs.rungs, of_scene=not isinstance(subject, Case))


def rungs_asked(names: Sequence[str] | None, *, of_scene: bool) -> list[str]:
    """Return the fidelities that are requested, once each, in its order.

    Raises
    ------
    BadInput
        A name that no rung of a case, or of a scene, has; or fewer than two rungs.
    """
    known = [rung.name for rung in (SCENE_FIDELITIES if of_scene else FIDELITIES)]
    for name in names or ():
        if name not in known:
            raise BadInput.of("rungs", name, f"among {', '.join(known)}", "Or leave it out: all are run.")
    asked = [name for name in known if names is None or name in names]
    if len(asked) < LEAST:
        raise BadInput.of("rungs", asked, "at least two rungs", "An error needs two to compare.")
    return asked


def normalized(subject: Case | SceneInput, inputs: Inputs) -> Json:
    """Return the rungs in their order, and full contact if it is requested."""
    beside = {} if inputs.full_contact is None else {"full_contact": inputs.full_contact}
    return {"rungs": rungs_asked(inputs.rungs, of_scene=not isinstance(subject, Case)), **beside}


def read(file: Path) -> Frontier | SceneFrontier:
    """Return the study in a file of `Frontier.to_json` of either library.

    Not stored, and so not in it: what full finite-element contact gave on a case; the orders of the vibration
    that the rungs of a scene were compared to, which are NaN.
    """
    content = json.loads(file.read_text(encoding="utf-8"))
    return _of_case(content) if "solves" in content else _of_scene(content)


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


RUN = Computation(
    frontier_of,
    lambda found: found.to_json(),
    read,
    marks=dict.fromkeys(("rungs", "knee", "chosen")),
    check=check,
    normalized=normalized,
)
