"""The verbs of studies: arguments and options from the registry and the fields of their inputs."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from inspect import Parameter, Signature
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from typer.core import TyperGroup

from lineofaction.cli.guard import computing
from lineofaction.cli.options import AsCsv, AsJson, Scheduler, TableService, TaskWorkers
from lineofaction.cli.overrides import file_argument, overridable
from lineofaction.cli.verb_parameters import keyword
from lineofaction.gearbox.input_file import InputFile
from lineofaction.gearbox.registry import STUDIES
from lineofaction.gearbox.schemas.spelling import item_type, spelling_of
from lineofaction.gearbox.study import Study

if TYPE_CHECKING:
    from pydantic.fields import FieldInfo

GROUPS = ("start", "pair", "gearbox", "design", "sound", "trust", "results", "service")
"""Groups of verbs in the help."""


class StudyGroup(TyperGroup):
    """A group of verbs that includes the verbs of all studies; each is made on its first request.

    A study whose verb is in the group already has that one.
    """

    def list_commands(self, ctx: Any) -> list[str]:
        """Return the names of all verbs."""
        return list(dict.fromkeys([*super().list_commands(ctx), *STUDIES]))

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        """Return a verb."""
        command, study = super().get_command(ctx, cmd_name), STUDIES.get(cmd_name)
        return command if command is not None or study is None else _command(study)

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """List the verbs by groups, each with its whole sentence."""
        groups: dict[str, list[tuple[str, str]]] = {group: [] for group in GROUPS}
        for name in self.list_commands(ctx):
            verb: Any = super().get_command(ctx, name)
            if verb is not None:
                groups[verb.rich_help_panel].append((name, verb.short_help or verb.help))
            else:  # from its row: the models of its inputs are not loaded
                groups[STUDIES[name].group].append((name, STUDIES[name].description))
        for group, verbs in groups.items():
            with formatter.section(group.capitalize()):
                formatter.write_dl(verbs)


def _command(study: Study) -> Any:
    verb = typer.Typer(add_completion=False, rich_markup_mode=None)
    example = f"Example: loa {study.name} {study.example}"
    called = overridable(study.argument, study.takes.subject)(_verb(study))
    help_texts: dict[str, Any] = {"short_help": study.description, "rich_help_panel": study.group}
    verb.command(study.name, epilog=example, **help_texts)(computing(called))
    return typer.main.get_command(verb)


def _verb(study: Study) -> Callable[..., None]:
    """Return the function of a verb, with the signature that it is called by."""

    def verb(**options: Any) -> None:
        from lineofaction.cli.run_study import run_study  # noqa: PLC0415 (start-up time)

        run_study(study, options)

    verb.__doc__ = study.description
    verb.__signature__ = Signature(list(_parameters(study)))  # type: ignore[attr-defined]
    return verb


def _parameters(study: Study) -> Iterator[Parameter]:
    """Yield argument and options of a verb."""
    metavar = study.takes.subject.upper().replace(" ", "_")
    argument = file_argument(f"{study.takes.subject.capitalize()} file", metavar)
    yield keyword(study.argument, Annotated[list[InputFile] if study.several else InputFile, argument])
    if study.takes.from_file:
        absent = "all defaults" if study.takes.bare else "the one in the folder"
        file = typer.Argument(help=f"Study file (TOML); left out: {absent}.")
        yield keyword("study", Annotated[Path | None, file], None)
    else:
        yield from (_option(name, field) for name, field in study.inputs.model_fields.items())
    target_kind = "Folder, or a file" if study.folder else "File to write,"
    names = ("-o", "--output", *study.aliases)
    target = typer.Option(*names, help=f"{target_kind} ending in one of {', '.join(study.accepted)}.")
    yield keyword("output", Annotated[Path | None, target], None)
    yield keyword("workers", TaskWorkers, 1)
    yield keyword("scheduler", Scheduler, None)
    if study.takes.subject != "case":
        yield keyword("service", TableService, None)
    if ".csv" in study.endings:
        yield keyword("csv", AsCsv, False)
    yield keyword("json", AsJson, False)


def _option(name: str, field: FieldInfo) -> Parameter:
    """Return the option of a field of the inputs; lists are typed as text."""
    spelling = spelling_of(field)
    option = typer.Option(*([spelling.option] if spelling else []), help=field.description)
    if spelling and spelling.value is not None:
        return keyword(name, Annotated[bool, option], field.default == spelling.value)
    if spelling and spelling.file:
        return keyword(name, Annotated[Path | None, option], field.default)
    kind = str | None if item_type(field) else field.annotation
    if field.is_required() and not item_type(field):
        return keyword(name, Annotated[kind, option])
    typed = None if field.is_required() else field.default  # as typed; an empty list becomes None
    if isinstance(typed, tuple):
        typed = ",".join(item if isinstance(item, str) else f"{item:g}" for item in typed) or None
    return keyword(name, Annotated[kind, option], typed)
