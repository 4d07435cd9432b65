"""The row of a study in the registry: what it takes and returns, and how verb, process and function call it.

The same row is an attribute of classes: on a class that lists studies it is the row itself, on a client it is
the process of the service that computes the study.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any, Generic, ParamSpec, Protocol, Self, TypeVar, overload

from lineofaction.gearbox.loading import load

if TYPE_CHECKING:
    from pathlib import Path

    from dynamics.results import RunResult
    from lineofaction.gearbox.progress_bars import ProgressChoice
    from lineofaction.gearbox.schemas.figures import Figures
    from lineofaction.gearbox.schemas.model import BoundaryModel
    from lineofaction.gearbox.studies.computation import Computation
    from lineofaction.gearbox.subjects import Subject
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
    """Whether the verb reads the inputs from a file and the client takes a mapping, instead of options."""
    bare: bool = False
    """Whether the file of the inputs may be left out, so that all inputs have their defaults."""


class Offered(Generic[P, T, F]):
    """A descriptor: the class has the study's row as the attribute, an instance (a client) the process."""

    name: str
    """Name of the process: that of the attribute, with hyphens."""

    def __set_name__(self, _owner: type, name: str) -> None:
        object.__setattr__(self, "name", name.replace("_", "-"))  # rows are frozen dataclasses

    @overload
    def __get__(self, caller: None, owner: type) -> Self: ...
    @overload
    def __get__(self, caller: _Caller[Self, C], owner: type) -> C: ...
    def __get__(self, caller: Any, owner: type) -> Any:
        """Return the row where the attribute is read from a class, the process where from a client."""
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
    """Arguments of the verb in the example of its help."""
    group: str
    """Group under which the help lists the verb."""
    kind: str
    """Kind of the result, which is the process' output too."""
    stages: tuple[tuple[str, float], ...]
    """Stages of the work, in order, and their shares of the time."""
    version: str = "2"
    """Part of the result's content hash: a new version makes stored results be computed again."""
    folder: str = ""
    """Name without ending of the files that the verb writes to a folder; empty: the verb writes one file."""
    further: tuple[str, ...] = ()
    """Endings of files that this verb writes beyond those of all studies; CSV can be printed too."""
    several: bool = False
    """Whether the verb takes several files."""
    housed: bool = False
    """Whether the study is of a housing, which the scene must then have as a solid."""
    internal: bool = False
    """Whether the study is of a ring gear, which the pair of the case must then have."""
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
        """Endings that the user may name for the output: `endings`, and PDF, which is never the default."""
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

    # the first form has the inputs of this study alone; each other has one argument that all studies take
    @overload
    def __call__(self, subject: Subject, *inputs: Q.args, **fields: Q.kwargs) -> T: ...
    @overload
    def __call__(self, subject: Subject, inputs: Mapping[str, Any], **further: Any) -> T: ...
    @overload
    def __call__(self, subject: Subject, *, run: RunResult | None, **further: Any) -> T: ...
    @overload
    def __call__(self, subject: Subject, *, workers: Workers | None, **further: Any) -> T: ...
    @overload
    def __call__(self, subject: Subject, *, progress: ProgressChoice, **further: Any) -> T: ...
    @overload
    def __call__(self, subject: Subject, *, folder: Path | None, **further: Any) -> T: ...
    def __call__(  # type: ignore[misc]  # the first form has all of Q by position, this one at most one
        self,
        subject: Subject,
        inputs: Mapping[str, Any] | None = None,
        *,
        run: RunResult | None = None,
        workers: Workers | None = None,
        progress: ProgressChoice = None,
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
        progress : callable or bool, optional
            Function that is called as progress(stage, fraction); True: bars on a terminal, a bar in a
            notebook; False: nothing. Default: in a notebook a bar after two seconds, elsewhere nothing.
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
    """A row of the registry that is also an attribute of clients, and has a function for Python users."""

    takes: Takes[P, Q, T, F]

    @cached_property
    def function(self) -> StudyFunction[Q, T]:
        """The study as `lineofaction` has it."""
        return StudyFunction(self)
