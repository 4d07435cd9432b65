"""Accuracy study of a case or a scene: the same subject at several fidelities, by cost and error.

A *fidelity* is a level of modeling. Inputs call the requested fidelities "rungs". *Full contact* is the
reference by finite elements in contact, which only cases have.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from bounds.types import Json
from dynamics.accuracy import FIDELITIES as SCENE_FIDELITIES
from dynamics.accuracy import Frontier as SceneFrontier
from dynamics.accuracy import frontier as frontier_of_scene
from dynamics.accuracy import runs_of_frontier
from fe_contact.analysis.request.request import Checked
from fe_contact.analysis.studies.frontier import FIDELITIES, Frontier, frontier, predicted_frontier
from fe_contact.analysis.studies.full_contact_cost import ORIGIN
from fe_contact.errors import chosen
from lineofaction.gearbox.convert.boundary_errors import boundary_errors
from lineofaction.gearbox.convert.case import study_options
from lineofaction.gearbox.convert.checked_case import CheckedCase
from lineofaction.gearbox.convert.scene import TabledScene
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.studies.computation import Computation, Means, record_file
from lineofaction.gearbox.studies.cost import StudyCost, Work
from lineofaction.gearbox.studies.frontier import FrontierFigures, Inputs
from lineofaction.gearbox.studies.run_cost import runs_cost
from lineofaction.gearbox.units import in_um

MIN = 2
"""Least number of fidelities of a study: an error needs two to compare."""


class _FrontierStudy(
    Computation[
        CheckedCase | SceneInput, CheckedCase | TabledScene, Inputs, FrontierFigures, Frontier | SceneFrontier
    ]
):
    inputs, answer = Inputs, FrontierFigures
    file = record_file(("accuracy study of a case", Frontier), ("accuracy study of a scene", SceneFrontier))

    def check(self, subject: CheckedCase | SceneInput, inputs: Inputs) -> None:
        """Refuse an impossible case, an unknown fidelity, and full contact of a scene."""
        if isinstance(subject, CheckedCase):
            _ = subject.request(_table, inputs)  # raises for an impossible case
        else:
            for name in ("full_contact", "up_to"):
                if (value := getattr(inputs, name)) != Inputs.model_fields[name].default:
                    raise BadInput.of(name, value, "left out for a scene", "Give it with a case.")
        _requested(inputs, of_scene=not isinstance(subject, CheckedCase))

    def normalized(self, subject: CheckedCase | SceneInput, inputs: Inputs) -> Json:
        full_contact = {} if inputs.full_contact is None else {"full_contact": inputs.full_contact}
        return {"rungs": _requested(inputs, of_scene=not isinstance(subject, CheckedCase)), **full_contact}

    def predicted(
        self, subject: CheckedCase | SceneInput, inputs: Inputs, cache: Path | None
    ) -> StudyCost | None:
        """Return the cost of the requested fidelities; a scene's follows from the steps of each tolerance."""
        names = _requested(inputs, of_scene=not isinstance(subject, CheckedCase))
        if isinstance(subject, SceneInput):
            return runs_cost(subject, lambda scene: runs_of_frontier(scene, names), "ladder", "minimal")
        with boundary_errors():
            seconds = predicted_frontier(subject.request(_table, inputs), names, cache)
        return StudyCost(tuple(Work(name, cost, 1.0, "ladder") for name, cost in seconds.items()))

    def compute(
        self, subject: CheckedCase | TabledScene, inputs: Inputs, means: Means
    ) -> Frontier | SceneFrontier:
        """Study a scene, or a case over all base pitches that differ and with a full receipt."""
        names = _requested(inputs, of_scene=not isinstance(subject, CheckedCase))
        report, full_contact = means.report, inputs.full_contact
        with boundary_errors():
            if isinstance(subject, TabledScene):
                return frontier_of_scene(subject.scene, fidelities=names, progress=report)
            return frontier(
                subject.request(_table, inputs),
                fidelities=names,
                full_contact=full_contact,
                progress=report,
            )

    def _derived(self, study: Frontier | SceneFrontier) -> Json:
        if isinstance(study, SceneFrontier):
            return {}
        solves, measured = study.solves, study.full_contact
        return {
            "full_finite_element_contact": [level.to_json(solves) for level in study.known_full_contact],
            "full_finite_element_contact_origin": ORIGIN,
            "full_contact": None if measured is None else in_um(measured.to_json(solves)),
        }


def _table(case: CheckedCase, _inputs: Inputs) -> Checked:
    return Frontier.request(case.pair, replace(case.axes, pitches=None), study_options(case.options))


def _requested(inputs: Inputs, *, of_scene: bool) -> list[str]:
    """Return the fidelities that are requested, once each, in the order of their cost."""
    known = [fidelity.name for fidelity in (SCENE_FIDELITIES if of_scene else FIDELITIES)]
    with boundary_errors():
        names = chosen("rungs", inputs.rungs, known, "Or leave it out: all are run.")
    if not of_scene:
        names = [name for name in names if known.index(name) <= known.index(inputs.up_to)]
    if len(names) < MIN:
        raise BadInput.of("rungs", names, "at least two fidelities", "An error needs two to compare.")
    return names


RUN = _FrontierStudy()
