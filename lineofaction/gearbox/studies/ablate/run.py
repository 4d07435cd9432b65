"""Ablation of a case or a scene."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from bounds.types import Json
from dynamics.ablation import Ablation as SceneAblation
from dynamics.ablation import ablate as ablate_scene
from dynamics.ablation import runs_of_ablation
from dynamics.effects import EFFECTS as SCENE_EFFECTS
from fe_contact.analysis.request.request import Checked
from fe_contact.analysis.studies.ablation import Ablation, ablate, predicted_ablation
from fe_contact.effects import EFFECTS
from fe_contact.errors import chosen
from lineofaction.gearbox.convert.boundary_errors import boundary_errors
from lineofaction.gearbox.convert.checked_case import CheckedCase
from lineofaction.gearbox.convert.scene import TabledScene
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.studies.ablate import AblateFigures, Inputs
from lineofaction.gearbox.studies.computation import Computation, Means, record_file
from lineofaction.gearbox.studies.cost import StudyCost, Work
from lineofaction.gearbox.studies.run_cost import runs_cost


class _AblateStudy(
    Computation[
        CheckedCase | SceneInput, CheckedCase | TabledScene, Inputs, AblateFigures, Ablation | SceneAblation
    ]
):
    inputs, answer = Inputs, AblateFigures
    file = record_file(("ablation of a case", Ablation), ("ablation of a scene", SceneAblation))

    def check(self, subject: CheckedCase | SceneInput, inputs: Inputs) -> None:
        """Refuse a case without a pair that can be computed, and an unknown effect."""
        if isinstance(subject, CheckedCase):
            _ = subject.request(_table, inputs)  # for its refusals
        _requested(inputs.only, of_scene=not isinstance(subject, CheckedCase))

    def normalized(self, subject: CheckedCase | SceneInput, inputs: Inputs) -> Json:
        return {"only": _requested(inputs.only, of_scene=not isinstance(subject, CheckedCase))}

    def predicted(
        self, subject: CheckedCase | SceneInput, inputs: Inputs, cache: Path | None
    ) -> StudyCost | None:
        """Return the cost of a case's tables or a scene's runs: with all effects, and without each."""
        if isinstance(subject, SceneInput):
            return runs_cost(subject, lambda scene: runs_of_ablation(scene, inputs.only), "ablation")
        with boundary_errors():
            tables = predicted_ablation(subject.request(_table, inputs), inputs.only, cache)
        contacts = Work("contacts", float(np.mean(tables.contacts)), len(tables.contacts), "ablation")
        return StudyCost((Work("gears", tables.bodies, stage="ablation"), contacts), tables.bytes)

    def compute(
        self, subject: CheckedCase | TabledScene, inputs: Inputs, means: Means
    ) -> Ablation | SceneAblation:
        """Toggle the effects of a case, at its nominal center distance, or of a scene."""
        with boundary_errors():
            if isinstance(subject, TabledScene):
                return ablate_scene(subject.scene, inputs.only, means.report, means.workers)
            return ablate(subject.request(_table, inputs), run=means.analysis, only=inputs.only)


def _table(case: CheckedCase, _inputs: Inputs) -> Checked:
    return Ablation.request(*case.converted)


def _requested(only: Sequence[str] | None, *, of_scene: bool) -> list[str]:
    """Return the effects to toggle, once each, in the order of their registry."""
    known = [effect.name for effect in EFFECTS]
    if of_scene:
        known = [effect.name for effect in SCENE_EFFECTS]
    with boundary_errors():
        return chosen("only", only, known, "Or leave it out: all are toggled.")


RUN = _AblateStudy()
