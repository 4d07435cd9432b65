"""The work of a study, a class with one instance in its module `run`, and the netCDF files of results."""

from __future__ import annotations

import json
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import reduce
from operator import or_
from pathlib import Path
from typing import Any, ClassVar, Generic, TypeVar

from bounds.types import Json
from dynamics.results import RunResult
from dynamics.results.array_file import ArrayFile
from fe_contact.options import Run
from lineofaction.gearbox.convert.case import case_at
from lineofaction.gearbox.convert.checked_case import CheckedCase
from lineofaction.gearbox.convert.scene import TabledScene
from lineofaction.gearbox.schemas.figures import Figures
from lineofaction.gearbox.schemas.flank_point import FlankPoint
from lineofaction.gearbox.schemas.model import BoundaryModel
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.studies.cost import StudyCost
from lineofaction.gearbox.studies.figures import figures_of, metadata_of
from lineofaction.gearbox.studies.motion import OfferedMotion
from lineofaction.gearbox.studies.scene_before_tables import CASES
from model_studies.record_file import read_record, write_record
from model_studies.workers import InProcess, Workers

Written = TypeVar("Written")
Subject = TypeVar("Subject")
Inputs = TypeVar("Inputs", bound=BoundaryModel)
Answer = TypeVar("Answer", bound=Figures)
Result = TypeVar("Result")


@dataclass(frozen=True)
class ResultFile:
    """The netCDF file of a result."""

    attribute: str
    """Attribute of the file by which its kind is known."""
    values: tuple[str, ...]
    """Values of the attribute that such files have."""
    write: Callable[[Any, Path], object]
    read: Callable[[Path], Any]
    """`write`, `read`: Functions from result and path to the file, and from the path to the result; `read`
    raises the libraries' errors or ValueError.
    """
    result: Any
    """Type that `read` returns, as an annotation: the client's types are written from it."""

    def holds(self, attributes: Mapping[str, object]) -> bool:
        """Whether a file with these attributes is a file of this kind."""
        return attributes.get(self.attribute) in self.values


def array_file(kind: type[ArrayFile]) -> ResultFile:
    """Return the file of a result of dynamics that has its own table of fields."""
    return ResultFile("schema", (kind.SCHEMA,), kind.to_netcdf, kind.from_netcdf, kind)


def record_file(*kinds: tuple[str, type]) -> ResultFile:
    """Return the file of dataclasses, whose fields determine its contents, by kind."""
    by_schema = {f"lineofaction {name}": kind for name, kind in kinds}

    def write(result: object, file: Path) -> None:
        schema = next(name for name, kind in by_schema.items() if type(result) is kind)
        write_record(result, file, schema)

    result = reduce(or_, by_schema.values())
    return ResultFile("schema", tuple(by_schema), write, lambda file: read_record(file, by_schema), result)


@dataclass(frozen=True)
class Means:
    """The means that a study works with."""

    home: Path
    """Folder of the caches."""
    report: Callable[[str, float], None]
    """Function that is called as report(stage, fraction) on progress."""
    workers: Workers = field(default_factory=InProcess)
    """Executor of the tasks."""
    cancel: Callable[[], bool] | None = None
    """Function that returns whether to end with the best so far; None: never."""
    folder: Path | None = None
    """Folder for the runs that a study stores in full; None: no run is stored."""
    run: RunResult | None = None
    """Run whose bearing forces replace those of the linear response; None: the linear response."""

    @property
    def analysis(self) -> Run:
        """The settings of analyses of gear pairs: shared workers, and a cache of condensed gears."""
        return Run(self.workers, self.home / "compliance", self.report)


class Computation(ABC, Generic[Written, Subject, Inputs, Answer, Result]):
    """The work of a study.

    What is studied is `Written` in its units, and for `compute` a `Subject`: a case as it is
    (`CheckedCase`), a scene with the tables of its meshes (`TabledScene`), or only with its housings
    (`HousedScene`).
    """

    inputs: type[Inputs]
    """Model of the inputs."""
    answer: type[Answer]
    """Model of the figures of a result."""
    file: ResultFile
    """File format of a result."""
    tables: ClassVar[bool] = True
    """Whether a scene comes with the tables of its meshes."""
    interruptible: ClassVar[bool] = False
    """Whether the work ends with the best so far when `Means.cancel` returns True."""
    resumed: ClassVar[bool] = False
    """Whether finished tasks are stored for another attempt after an attempt that died."""
    writers: ClassVar[Mapping[str, Callable[[Any, Any, Path], object]]] = {}
    """Writers of further files of the verb, by their ending: called with result, subject, and file."""

    def narrowed(self, subject: Written, _inputs: Inputs) -> Written:
        """Return the part of the subject that the inputs choose, which is checked, hashed and computed."""
        return subject

    def check(self, subject: Written, inputs: Inputs) -> None:
        """Refuse inputs that the schema accepts and the work cannot use; raises `BadInput`."""

    def predicted(self, _subject: Written, _inputs: Inputs, _cache: Path | None) -> StudyCost | None:
        """Return the cost once a scene has its tables; None: nothing predicts it.

        The cases of a scene are written out. What is in the cache of compliances costs nothing.
        """
        return None

    def known_before(self, _subject: Written, _inputs: Inputs) -> str:
        """Return what is known of the result in words before anything is computed; empty: nothing.

        The cases of a scene are written out.
        """
        return ""

    def normalized(self, _subject: Written, inputs: Inputs) -> Json:
        """Return the inputs of a job as JSON, alike for equal questions; may raise `BadInput`."""
        return inputs.model_dump(mode="json")

    @abstractmethod
    def compute(self, subject: Subject, inputs: Inputs, means: Means) -> Result:
        """Return the result.

        Raises `BadInput`: no such pair, scene, part or request; `JobFailed`: no mesh, no equilibrium, or
        points without a solution.
        """

    def figures(self, result: Result) -> Json:
        """Return the figures of a result in the units of the boundary, as they are printed and served."""
        return figures_of(self.answer, result, metadata_of(result), **self._derived(result))

    def _derived(self, _result: Result) -> Json:
        return {}

    def motions(self, _result: Result) -> Sequence[OfferedMotion]:
        """Return the motions of the unit that a result holds, as they are listed."""
        return ()

    def save_figures(self, result: Result, file: Path) -> None:
        """Write the figures as JSON."""
        file.write_text(f"{json.dumps(self.figures(result), allow_nan=False)}\n", encoding="utf-8")

    def warnings(self, _result: Result) -> list[Json] | None:
        """Return warnings of a result beyond those of its case, which others assess; None: none."""
        return None

    def failure(self, _result: Result) -> str:
        """Return a sentence on missing parts of a result; empty if nothing is missing."""
        return ""

    def stored_runs(self, _result: Result, _means: Means) -> Mapping[str, Path]:
        """Return the runs in `Means.folder`, by the hash that they are stored under."""
        return {}

    def joined(self, results: Mapping[str, Result]) -> Result:
        """Return results of several cases, by the names of their files, as one."""
        raise NotImplementedError


CaseStudy = Computation[CheckedCase, CheckedCase, Inputs, Answer, Result]
"""The work of a study of a case."""
SceneStudy = Computation[SceneInput, TabledScene, Inputs, Answer, Result]
"""The work of a study of a scene with the tables of its meshes."""


class PointStudy(CaseStudy[FlankPoint, Answer, Result]):
    """The work of a study of a case at one load and one alignment, which are the case's own then."""

    def narrowed(self, case: CheckedCase, inputs: FlankPoint) -> CheckedCase:
        """Return the case at one load and one alignment."""
        return CASES.of(case_at(case.case, inputs))

    def check(self, case: CheckedCase, _inputs: FlankPoint) -> None:
        """Refuse a case that cannot be."""
        _ = case.at_point

    def normalized(self, _case: CheckedCase, _inputs: FlankPoint) -> Json:
        """Return nothing: the case has all of it."""
        return {}
