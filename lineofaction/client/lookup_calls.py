"""Calls before anything is computed: plans, drawings, examples, effects, files."""

from __future__ import annotations

import base64
import warnings
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from lineofaction.client.offers import subject_inputs
from lineofaction.client.steps import Steps
from lineofaction.client.surface import Surface, operation
from lineofaction.gearbox import schemas
from lineofaction.gearbox.loading import load
from lineofaction.gearbox.problems import BadInput

if TYPE_CHECKING:
    from pydantic import BaseModel

    from lineofaction.gearbox.subjects import CaseLike, SceneLike
    from service.schemas.answers import EffectBody, ExampleBody, UnitBody


T = TypeVar("T")
M = TypeVar("M", bound="BaseModel")


class LookupCalls(Surface):
    """Answers that need no job."""

    @operation
    def plan(self, case: CaseLike, *, time_budget_s: float | None = None) -> Steps[schemas.PlanBody]:
        """Return the plan of the analysis of a case: discretization, predicted cost and errors.

        `time_budget_s`: CPU seconds that may be spent.
        """
        inputs = subject_inputs("case", case) | {"time_budget_s": time_budget_s}
        return (yield from self._answer("/v1/plans", {"inputs": inputs}, schemas.PlanBody.model_validate))

    @operation
    def outline(self, case: CaseLike) -> Steps[schemas.OutlineBody]:
        """Return the drawing of both gears, the path of contact and the figures of the pair."""
        body = {"inputs": subject_inputs("case", case)}
        return (yield from self._answer("/v1/cases/outline", body, schemas.OutlineBody.model_validate))

    @operation
    def examples(self) -> Steps[tuple[ExampleBody, ...]]:
        """Return cases to begin with."""
        return self._listed("/v1/examples", "ExampleBody")

    @operation
    def effects(self) -> Steps[tuple[EffectBody, ...]]:
        """Return the optional physics, which a case switches in its table ``[effects]``."""
        return self._listed("/v1/effects", "EffectBody")

    @operation
    def case_from_toml(self, toml: str) -> Steps[schemas.Case]:
        """Return the case in the text of a case file; raises `BadInput` with the lines at fault."""
        return self._validated("/v1/cases/from-toml", toml, "case", schemas.Case)

    @operation
    def case_to_toml(self, case: CaseLike) -> Steps[str]:
        """Return a case with all defaults as the text of a case file."""
        body = {"inputs": subject_inputs("case", case)}
        return (yield from self._answer("/v1/cases/to-toml", body, _text))

    @operation
    def case_as_measured(
        self, case: CaseLike, sheet: Path, gear: str, loaded: str = "right", cutoff_mm: float | None = None
    ) -> Steps[schemas.Case]:
        """Return a case with the measured deviations of one gear on its loaded flanks.

        Raises `BadInput`: a line of the sheet cannot be read, or a trace cannot be evaluated. Warns of points
        that are left out.

        Parameters
        ----------
        sheet : Path
            Pitches and traces of the inspection, CSV.
        gear, loaded : str
            "pinion" or "wheel", and its loaded flanks, "left" or "right".
        cutoff_mm : float, optional
            Cut-off of the filter that separates slope and form; default: that of the standard.
        """
        measured = {"csv": _read(sheet).decode(), "gear": gear, "loaded": loaded, "cutoff_mm": cutoff_mm}
        return self._as_made(case, {"measured": measured})

    @operation
    def case_of_class(self, case: CaseLike, tolerance_class: int, seed: int = 0) -> Steps[schemas.Case]:
        """Return a case with deviations of both gears drawn at random within a class of ISO 1328-1:2013.

        The same seed gives the same deviations.
        """
        return self._as_made(case, {"tolerance_class": tolerance_class, "seed": seed})

    @operation
    def scene_from_toml(self, toml: str) -> Steps[schemas.SceneInput]:
        """Return the scene in the text of a scene file; raises `BadInput` with the lines at fault."""
        return self._validated("/v1/scenes/from-toml", toml, "scene", schemas.SceneInput)

    @operation
    def scene_to_toml(self, scene: SceneLike) -> Steps[str]:
        """Return a scene, its case files written out, as the text of a scene file."""
        body = {"inputs": subject_inputs("scene", scene)}
        return (yield from self._answer("/v1/scenes/to-toml", body, _text))

    @operation
    def open_unit(self, file: Path, assume: Sequence[str] = ()) -> Steps[UnitBody]:
        """Return the gear unit in a REXS file (.rexs, .rexsj, .rexsz) as cases, scene and account.

        Its `left_out` says what the file has and the scene has not. Raises `BadInput`: the file cannot be
        read, is no sound REXS file, or has no such component; the message names it.

        Parameters
        ----------
        file : Path
            REXS file.
        assume : sequence of str
            Values that replace those of the file, ``"14.helix_angle_reference_diameter=-12"``.
        """
        body = {"rexs_base64": base64.b64encode(_read(file)).decode(), "assume": list(assume)}
        unit: UnitBody = yield from self._answer("/v1/units/open", body, _model("UnitBody").model_validate)
        return unit

    def _answer(self, path: str, body: dict[str, Any], reader: Callable[[Any], T]) -> Steps[T]:
        return self.session.exchange.read(reader, "POST", path, json=body)

    def _as_made(self, case: CaseLike, deviations: dict[str, Any]) -> Steps[schemas.Case]:
        def read_case(answer: dict[str, Any]) -> schemas.Case:
            for text in answer["left_out"]:
                warnings.warn(f"left out of the case: {text}", stacklevel=2)
            return schemas.validated(schemas.Case, answer["case"])

        return self._answer(
            "/v1/cases/as-made", {"inputs": subject_inputs("case", case), **deviations}, read_case
        )

    def _validated(self, path: str, toml: str, name: str, model: type[M]) -> Steps[M]:
        return self._answer(path, {"toml": toml}, lambda answer: schemas.validated(model, answer[name]))

    def _listed(self, path: str, model: str) -> Steps[tuple[Any, ...]]:
        return self.session.exchange.read(
            lambda answer: tuple(map(_model(model).model_validate, answer)), "GET", path
        )


def _read(file: Path) -> bytes:
    try:
        return Path(file).read_bytes()
    except OSError as error:
        raise BadInput.of("file", str(file), f"a file that can be read ({error.strerror})") from None


def _text(answer: dict[str, Any]) -> str:
    return str(answer["toml"])


def _model(name: str) -> Any:
    """Return a model of answers by its name; the first call imports the module of all of them."""
    return load(f"service.schemas.answers:{name}")
