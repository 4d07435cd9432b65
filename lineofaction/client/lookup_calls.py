"""What a service says before anything is computed: plans, drawings, examples, effects, files."""

from __future__ import annotations

import base64
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, TypeVar

from lineofaction.client.portable import CaseLike, SceneLike, case_inputs, scene_inputs
from lineofaction.client.steps import Steps
from lineofaction.client.surface import Surface, operation
from lineofaction.gearbox import schemas
from lineofaction.gearbox.problems import BadInput
from service.schemas.offers import EffectBody, ExampleBody
from service.schemas.unit import UnitBody

T = TypeVar("T")


class LookupCalls(Surface):
    """Answers that need no job."""

    @operation
    def plan(self, case: CaseLike, *, time_budget_s: float | None = None) -> Steps[schemas.PlanBody]:
        """Return what the analysis of a case will be, cost and be wrong by.

        Parameters
        ----------
        case : model, mapping or Path
        time_budget_s : float, optional
            CPU seconds that may be spent.
        """
        inputs = case_inputs(case) | {"time_budget_s": time_budget_s}
        return (yield from self._answer("/v1/plans", {"inputs": inputs}, schemas.PlanBody.model_validate))

    @operation
    def outline(self, case: CaseLike) -> Steps[schemas.OutlineBody]:
        """Return the drawing of both gears, the path of contact and the figures of the pair."""
        body = {"inputs": case_inputs(case)}
        return (yield from self._answer("/v1/cases/outline", body, schemas.OutlineBody.model_validate))

    @operation
    def examples(self) -> Steps[tuple[ExampleBody, ...]]:
        """Return cases to begin with."""
        exchange = self.session.exchange
        return (yield from exchange.read(_examples, "GET", "/v1/examples"))

    @operation
    def effects(self) -> Steps[tuple[EffectBody, ...]]:
        """Return the optional physics, which a case switches in its table ``[effects]``."""
        return (yield from self.session.exchange.read(_effects, "GET", "/v1/effects"))

    @operation
    def case_from_toml(self, toml: str) -> Steps[schemas.Case]:
        """Return the case in the text of a case file; raises `BadInput` with the lines at fault."""
        return (yield from self._answer("/v1/cases/from-toml", {"toml": toml}, _case))

    @operation
    def case_to_toml(self, case: CaseLike) -> Steps[str]:
        """Return a case with all defaults as the text of a case file."""
        body = {"inputs": case_inputs(case)}
        return (yield from self._answer("/v1/cases/to-toml", body, _text))

    @operation
    def scene_from_toml(self, toml: str) -> Steps[schemas.SceneInput]:
        """Return the scene in the text of a scene file; raises `BadInput` with the lines at fault."""
        return (yield from self._answer("/v1/scenes/from-toml", {"toml": toml}, _scene))

    @operation
    def scene_to_toml(self, scene: SceneLike) -> Steps[str]:
        """Return a scene, its case files written out, as the text of a scene file."""
        body = {"inputs": scene_inputs(scene)}
        return (yield from self._answer("/v1/scenes/to-toml", body, _text))

    @operation
    def open_unit(self, file: Path, assume: Sequence[str] = ()) -> Steps[UnitBody]:
        """Return the gear unit in a REXS file (.rexs, .rexsj, .rexsz) as cases, scene and account.

        Its `left_out` says what the file has and the scene has not.

        Parameters
        ----------
        file : Path
        assume : sequence of str
            Values over the file's, ``"14.helix_angle_reference_diameter=-12"``.

        Raises
        ------
        BadInput
            The file cannot be read, is no sound REXS file, or has no such component; the message names it.
        """
        try:
            data = Path(file).read_bytes()
        except OSError as error:
            raise BadInput.of("file", str(file), f"a file that can be read ({error.strerror})") from None
        body = {"rexs_base64": base64.b64encode(data).decode(), "assume": list(assume)}
        return (yield from self._answer("/v1/units/open", body, UnitBody.model_validate))

    def _answer(self, path: str, body: dict[str, Any], reader: Callable[[Any], T]) -> Steps[T]:
        """Return what `reader` makes of the answer to a body."""
        return (yield from self.session.exchange.read(reader, "POST", path, json=body))


def _case(answer: dict[str, Any]) -> schemas.Case:
    """Read a case."""
    return schemas.validated(schemas.Case, answer["case"])


def _scene(answer: dict[str, Any]) -> schemas.SceneInput:
    """Read a scene."""
    return schemas.validated(schemas.SceneInput, answer["scene"])


def _text(answer: dict[str, Any]) -> str:
    """Read the text of a file."""
    return str(answer["toml"])


def _effects(answer: list[Any]) -> tuple[EffectBody, ...]:
    """Read declarations of effects."""
    return tuple(map(EffectBody.model_validate, answer))


def _examples(answer: list[Any]) -> tuple[ExampleBody, ...]:
    """Read examples."""
    return tuple(map(ExampleBody.model_validate, answer))
