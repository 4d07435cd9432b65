"""The verbs of studies: arguments and options from the registry and the fields of their inputs."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from inspect import Parameter, Signature
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from typer.core import TyperGroup

from lineofaction.cli.guard import computing
from lineofaction.cli.options import (
    AsCsv,
    AsJson,
    DaskScheduler,
    TableService,
    TaskWorkers,
    file_argument,
    overridable,
)
from lineofaction.gearbox.input_file import InputFile
from lineofaction.gearbox.registry import STUDIES, Study
from lineofaction.gearbox.schemas.model import item_type, spelling_of

if TYPE_CHECKING:
    from pydantic.fields import FieldInfo


class StudyGroup(TyperGroup):
    """A group of verbs that has those of all studies too; each is made when it is requested.

    A study whose verb is in the group already has that one.
    """

    def list_commands(self, ctx: Any) -> list[str]:
        """Return the names of all verbs."""
        return list(dict.fromkeys([*super().list_commands(ctx), *STUDIES]))

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        """Return a verb."""
        own, study = super().get_command(ctx, cmd_name), STUDIES.get(cmd_name)
        return own if own is not None or study is None else _command(study)


def _command(study: Study) -> Any:
    verb = typer.Typer(add_completion=False, rich_markup_mode=None)
    example = f"Example: loa {study.name} {study.example}"
    called = overridable(study.argument, study.subject)(_verb(study))
    verb.command(study.name, epilog=example, short_help=study.description)(computing(called))
    return typer.main.get_command(verb)


def _verb(study: Study) -> Callable[..., None]:
    """Return the function of a verb, with the signature that it is called by."""

    def verb(**options: Any) -> None:
        from lineofaction.cli.study import run_study  # noqa: PLC0415 (start-up time)

        run_study(study, options)

    verb.__doc__ = study.description
    verb.__signature__ = Signature(list(_parameters(study)))  # type: ignore[attr-defined]
    return verb


def _parameters(study: Study) -> Iterator[Parameter]:
    """Yield argument and options of a verb."""
    metavar = study.subject.upper().replace(" ", "_")
    argument = file_argument(f"{study.subject.capitalize()} file", metavar)
    yield _parameter(study.argument, Annotated[list[InputFile] if study.several else InputFile, argument])
    if study.from_file:
        yield _study_file(study)
    else:
        yield from (_option(name, field) for name, field in study.inputs.model_fields.items())
    place = "Folder, or a file" if study.folder else "File to write,"
    names = ("-o", "--output", *study.aliases)
    target = typer.Option(*names, help=f"{place} ending in one of {', '.join(study.endings)}.")
    yield _parameter("output", Annotated[Path | None, target], None)
    if study.shared:
        yield _parameter("workers", TaskWorkers, 1)
        yield _parameter("dask", DaskScheduler, None)
    if study.subject != "case":
        yield _parameter("service", TableService, None)
    if ".csv" in study.endings:
        yield _parameter("csv", AsCsv, False)
    yield _parameter("json", AsJson, False)


def _study_file(study: Study) -> Parameter:
    """Return the argument of the file of the inputs."""
    if study.bare:
        file = typer.Argument(help="Study file (TOML); left out: all defaults.")
        return _parameter("study", Annotated[Path | None, file], None)
    return _parameter("study", Annotated[Path, typer.Argument(help="Study file (TOML).")])


def _option(name: str, field: FieldInfo) -> Parameter:
    """Return the option of a field of the inputs; lists are typed as text."""
    spelling = spelling_of(field)
    option = typer.Option(*([spelling.option] if spelling else []), help=field.description)
    if spelling and spelling.value is not None:
        return _parameter(name, Annotated[bool, option], field.default == spelling.value)
    if spelling and spelling.file:
        return _parameter(name, Annotated[Path | None, option], field.default)
    kind = str | None if item_type(field) else field.annotation
    if field.is_required():
        return _parameter(name, Annotated[str if item_type(field) else kind, option])
    return _parameter(name, Annotated[kind, option], _typed(field.default))


def _typed(default: Any) -> Any:
    """Return a default as it would be typed; an empty list is none."""
    if not isinstance(default, tuple):
        return default
    return ",".join(item if isinstance(item, str) else f"{item:g}" for item in default) or None


def _parameter(name: str, annotation: Any, default: Any = Parameter.empty) -> Parameter:
    return Parameter(name, Parameter.KEYWORD_ONLY, annotation=annotation, default=default)
