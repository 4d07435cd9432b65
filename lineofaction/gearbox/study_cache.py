"""The cache of a study, from which an interrupted study continues with the finished tasks."""

from __future__ import annotations

import shutil
from collections.abc import Iterator, Sequence
from contextlib import contextmanager

from fe_contact.solver_version import SOLVER_VERSION
from host.directories import cache_home
from lineofaction.gearbox.program_version import solver_version
from lineofaction.gearbox.schemas.model import BoundaryModel
from lineofaction.gearbox.study import Study
from model_studies.workers import Remembering, Workers
from model_studies.workers.content_digest import content_digest


@contextmanager
def cached_workers(
    study: Study, subjects: Sequence[BoundaryModel], inputs: BoundaryModel, workers: Workers
) -> Iterator[Workers]:
    """Provide workers that store finished tasks, for a study that can be resumed; else the same workers.

    A study that is interrupted or killed leaves its folder to the next one of the same subjects and inputs.
    """
    if not study.run.resumed:
        yield workers
        return
    content = (study.name, inputs.model_dump_json(), *(subject.model_dump_json() for subject in subjects))
    folder = cache_home() / "studies" / content_digest(content)
    version = f"{solver_version()} {SOLVER_VERSION}"
    yield Remembering(workers, folder, version)
    shutil.rmtree(folder, ignore_errors=True)
