"""A study as the registry states it: its row, of which are its function and the process of a client."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any, Generic, ParamSpec, Protocol, Self, TypeVar, overload

from lineofaction.gearbox.loading import load

if TYPE_CHECKING:
    from pathlib import Path

    from dynamics.results import RunResult
    from lineofaction.gearbox.schemas.figures import Figures
    from lineofaction.gearbox.schemas.model import BoundaryModel
    from lineofaction.gearbox.studies.computation import Computation
    from lineofaction.gearbox.subjects import Subject
    from model_studies.progress import Progress
    from model_studies.workers import Workers

    Work = Computation[Any, Any, Any, Any, Any]

P = ParamSpec("P")
Q = ParamSpec("Q")
T = TypeVar("T")
F = TypeVar("F", bound="Figures")
C = TypeVar("C")
S_contra = TypeVar("S_contra", contravariant=True)
C_co = TypeVar("C_co", covariant=True)


STUDIES = "lineofaction.gearbox.studies"
"""Package of the studies."""


class _Caller(Protocol[S_contra, C_co]):
    """Owner of the attributes that are studies: it makes a process of each study."""

    def process(self, study: S_contra, /) -> C_co: ...


@dataclass(frozen=True)
class Takes(Generic[P, Q, T, F]):
    """Arguments of a call of a study, and by its type parameters the result.

    The types are the parameters of a client's call, the parameters of the study's inputs, its result and its
    figures.
    """

    subject: str
    """Kind of input that is studied: a case, a scene, or either."""
    work: Callable[[], object]
    """Function that loads the `Computation`."""
    from_file: bool = False
    """Whether the inputs are a file of the verb and a mapping of the client, rather than options."""
    bare: bool = False
    """Whether the file of the inputs may be left out; all of them then have defaults."""


class Offered(Generic[P, T, F]):
    """An attribute of a class that is itself there, and of a client of that class a process.

    `name`: of the process: that of the attribute.
    """

    name: str

    def __set_name__(self, _owner: type, name: str) -> None:
        object.__setattr__(self, "name", name.replace("_", "-"))

    @overload
    def __get__(self, caller: None, owner: type) -> Self: ...
    @overload
    def __get__(self, caller: _Caller[Self, C], owner: type) -> C: ...
    def __get__(self, caller: Any, owner: type) -> Any:
        """Return the attribute of a class, the process of a client."""
        return self if caller is None else caller.process(self)


@dataclass(frozen=True)
class Study:
    """A row of the registry."""

    takes: Takes[..., ..., Any, Any]
    """Arguments of a call."""
    title: str
    action: str
    description: str
    """`title`, `action`, `description`: A noun, the words on the button of the page, and an imperative
    sentence on the work.
    """
    example: str
    """Arguments of the verb."""
    group: str
    """Group under which the help lists the verb."""
    kind: str
    """Kind of the result, which is the process' output too."""
    stages: tuple[tuple[str, float], ...]
    """Stages of the work, in order, and their shares of the time."""
    version: str = "2"
    """Part of the result's content hash: another one, and stored results are computed again."""
    folder: str = ""
    """Name of the files, but for their endings, that the verb writes to a folder; empty: it writes one file.
    """
    further: tuple[str, ...] = ()
    """Endings of files that the verb writes in addition to the files of all studies. CSV can be printed too.
    """
    several: bool = False
    """Whether the verb takes several files."""
    housed: bool = False
    """Whether the study is of a housing, which the scene must then have as a solid."""
    aliases: tuple[str, ...] = ()
    """Other names of the verb's option ``--output``."""
    name: str = field(default="", init=False)
    """Name among the `Studies`; package, process, verb and the client's method have the same name."""

    @property
    def argument(self) -> str:
        """The name of the argument for case or scene in the client's method and the verb."""
        return "subject" if self.takes.subject == "case or scene" else self.takes.subject

    @property
    def package(self) -> str:
        """The name of the package, and of the study's members in Python."""
        return self.name.replace("-", "_")

    @property
    def endings(self) -> tuple[str, ...]:
        """Endings of the files that the verb writes."""
        return (".nc", ".json", ".png", ".html", *self.further)

    @property
    def accepted(self) -> tuple[str, ...]:
        """Endings of a file that is named: a page is printed on request alone."""
        return (*self.endings, ".pdf")

    @property
    def inputs(self) -> type[BoundaryModel]:
        """The model of the inputs."""
        inputs: type[BoundaryModel] = load(f"{STUDIES}.{self.package}:Inputs")
        return inputs

    @property
    def run(self) -> Work:
        """The work of the study."""
        work: Any = self.takes.work()
        loaded: Work = work
        return loaded

    @property
    def answer(self) -> type[Figures]:
        """The model of the figures."""
        name = f"{self.name.title().replace('-', '')}Figures"
        figures: type[Figures] = load(f"{STUDIES}.{self.package}:{name}")
        return figures


class StudyFunction(Generic[Q, T]):
    """A study as a Python user calls it."""

    def __init__(self, study: Study) -> None:
        self.study = study

    @property
    def __doc__(self) -> str:  # type: ignore[override]
        """The description of the study and of its inputs."""
        fields = self.study.inputs.model_fields.items()
        inputs = "".join(f"\n{name}: {field.description or ''}" for name, field in fields)
        return f"{self.study.description}\n{inputs}"

    # by its inputs alone, or with at least one of what a call of any study takes
    @overload
    def __call__(self, subject: Subject, *inputs: Q.args, **fields: Q.kwargs) -> T: ...
    @overload
    def __call__(self, subject: Subject, inputs: Mapping[str, Any], **further: Any) -> T: ...
    @overload
    def __call__(self, subject: Subject, *, run: RunResult | None, **further: Any) -> T: ...
    @overload
    def __call__(self, subject: Subject, *, workers: Workers | None, **further: Any) -> T: ...
    @overload
    def __call__(self, subject: Subject, *, progress: Progress | None, **further: Any) -> T: ...
    @overload
    def __call__(self, subject: Subject, *, folder: Path | None, **further: Any) -> T: ...
    def __call__(  # type: ignore[misc]  # of Q it takes at most one by its place
        self,
        subject: Subject,
        inputs: Mapping[str, Any] | None = None,
        *,
        run: RunResult | None = None,
        workers: Workers | None = None,
        progress: Progress | None = None,
        folder: Path | None = None,
        **fields: Any,
    ) -> Any:
        """Study a case, a scene or a unit.

        Raises `BadInput`, `JobFailed`.

        Parameters
        ----------
        inputs, fields
            What is varied, in the units of the names; `help` of the function lists it.
        run : RunResult, optional
            Run whose bearing forces a study of housings takes.
        workers : Workers, optional
            Executor of the tasks; default: this process.
        progress : callable, optional
            Called as progress(stage, fraction).
        folder : Path, optional
            Folder for the runs that a study stores.

        Returns
        -------
        object
            The result of the study, with errors and cost; `lineofaction.report` draws it.
        """
        studied = load("lineofaction.gearbox.workbench:studied")
        varied = {**(inputs or {}), **fields}
        return studied(
            self.study, subject, varied, run=run, workers=workers, progress=progress, folder=folder
        )


@dataclass(frozen=True)
class StudyOf(Study, Offered[P, T, F], Generic[P, Q, T, F]):
    """A study that clients offer, and that is a function."""

    takes: Takes[P, Q, T, F]

    @cached_property
    def function(self) -> StudyFunction[Q, T]:
        """The study as `lineofaction` has it."""
        return StudyFunction(self)
