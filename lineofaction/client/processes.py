"""The processes of a service, each an attribute of the client."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Concatenate

from lineofaction.client.offers import offers
from lineofaction.client.process import F, Offered, P, T
from lineofaction.client.surface import Surface

if TYPE_CHECKING:
    from dynamics.results import RunResult
    from fe_contact.ste import SteDatabase
    from lineofaction.gearbox.schemas.figures import RunFigures, TableFigures
    from lineofaction.gearbox.studies.ablate.run import RUN as ABLATE
    from lineofaction.gearbox.studies.computation import Computation
    from lineofaction.gearbox.studies.deflect.run import RUN as DEFLECT
    from lineofaction.gearbox.studies.flank.run import RUN as FLANK
    from lineofaction.gearbox.studies.frontier.run import RUN as FRONTIER
    from lineofaction.gearbox.studies.listen.run import RUN as LISTEN
    from lineofaction.gearbox.studies.modes.run import RUN as MODES
    from lineofaction.gearbox.studies.noise.run import RUN as NOISE
    from lineofaction.gearbox.studies.optimize.run import RUN as OPTIMIZE
    from lineofaction.gearbox.studies.response.run import RUN as RESPONSE
    from lineofaction.gearbox.studies.root_stress.run import RUN as ROOT_STRESS
    from lineofaction.gearbox.studies.scatter.run import RUN as SCATTER
    from lineofaction.gearbox.studies.sensitivity.run import RUN as SENSITIVITY
    from lineofaction.gearbox.studies.steady.run import RUN as STEADY
    from lineofaction.gearbox.studies.study.run import RUN as STUDY
    from lineofaction.gearbox.studies.sweep.run import RUN as SWEEP
    from lineofaction.gearbox.studies.vibration.run import RUN as VIBRATION
    from lineofaction.gearbox.subjects import CaseLike, SceneLike, StudyLike

    Work = Computation[Any, Any, Any, F, T]

    def _as(study: Work[F, T], call: Callable[P, object]) -> Offered[P, T, F]: ...

    def _of_case(
        study: Work[F, T], inputs: Callable[P, object]
    ) -> Offered[Concatenate[CaseLike, P], T, F]: ...

    def _of_scene(
        study: Work[F, T], inputs: Callable[P, object]
    ) -> Offered[Concatenate[SceneLike, P], T, F]: ...

    def _of_either(
        study: Work[F, T], inputs: Callable[P, object]
    ) -> Offered[Concatenate[CaseLike | SceneLike, P], T, F]: ...

    def _case_and_file(case: CaseLike, study: StudyLike) -> None: ...

    def _scene_and_file(scene: SceneLike, study: StudyLike) -> None: ...

    def _scene_perhaps_file(scene: SceneLike, study: StudyLike = ...) -> None: ...


class Processes(Surface):
    """The processes of a service: call one for its result, `submit` for a job, `map` for many."""

    if TYPE_CHECKING:
        analyze: Offered[[CaseLike], SteDatabase, TableFigures]
        simulate: Offered[[SceneLike], RunResult, RunFigures]
        flank = _of_case(FLANK, FLANK.inputs)
        ablate = _of_either(ABLATE, ABLATE.inputs)
        frontier = _of_either(FRONTIER, FRONTIER.inputs)
        sensitivity = _of_case(SENSITIVITY, SENSITIVITY.inputs)
        root_stress = _of_case(ROOT_STRESS, ROOT_STRESS.inputs)
        optimize = _as(OPTIMIZE, _case_and_file)
        scatter = _of_case(SCATTER, SCATTER.inputs)
        sweep = _of_case(SWEEP, SWEEP.inputs)
        modes = _of_scene(MODES, MODES.inputs)
        response = _of_scene(RESPONSE, RESPONSE.inputs)
        noise = _of_scene(NOISE, NOISE.inputs)
        vibration = _of_scene(VIBRATION, VIBRATION.inputs)
        listen = _of_scene(LISTEN, LISTEN.inputs)
        steady = _of_scene(STEADY, STEADY.inputs)
        deflect = _as(DEFLECT, _scene_perhaps_file)
        study = _as(STUDY, _scene_and_file)


for _offer in offers().values():
    setattr(Processes, _offer.attribute, Offered(_offer))
