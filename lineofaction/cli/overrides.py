"""``--set`` and its shorthands: on every verb that takes a case or a scene, by one decorator."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Annotated, Any, TypeVar

import typer
from typer.models import OptionInfo

from lineofaction.cli.verb_parameters import keyword, parameters_of, with_parameters
from lineofaction.gearbox.input_file import InputFile, Override
from lineofaction.gearbox.number_list import number_list

R = TypeVar("R")
_SET = "Override a value of the file, as pair.pinion.tip_relief_um=20; repeatable; empty: remove the field."
_LEVEL = "Short for --set accuracy.level=: draft, standard or fine, instead of a tolerance."
_TOLERANCE = "Short for --set accuracy.tolerance=: relative, instead of a level."
_TORQUE = "Short for --set load.torque_n_m=[...]: torques on the driving gear in N m, as 50,100."
_SHORTHANDS: Mapping[str, tuple[str, tuple[str, ...]]] = {
    "level": ("accuracy.level", ("accuracy.tolerance", "accuracy.time_budget_s")),
    "tolerance": ("accuracy.tolerance", ("accuracy.level",)),
    "torque": ("load.torque_n_m", ("load.normal_force_n",)),
}
"""Path that each option sets, and paths that it then leaves out."""
_OF_ONE = ("output", "json", "csv")
"""Options that need a single case: one file to write, or one object to print."""


def file_argument(text: str, metavar: str) -> Any:
    """Return the argument of a case or scene file."""
    return typer.Argument(
        help=f"{text} (TOML, or JSON of the same shape), or the folder that has it.",
        parser=InputFile.named,
        metavar=metavar,
    )


CaseFile = Annotated[InputFile, file_argument("Case file", "CASE")]
SceneFile = Annotated[InputFile, file_argument("Scene file", "SCENE")]


def _options(subject: str) -> list[inspect.Parameter]:
    option = typer.Option("--set", metavar="PATH=VALUE", help=_SET)
    options = [keyword("overrides", Annotated[list[str] | None, option], None)]
    if subject != "scene":
        options += [
            keyword("level", Annotated[str | None, typer.Option(help=_LEVEL)], None),
            keyword("tolerance", Annotated[float | None, typer.Option(help=_TOLERANCE)], None),
            keyword("torque", Annotated[str | None, typer.Option(help=_TORQUE)], None),
        ]
    return options


def overridable(argument: str, subject: str = "case") -> Callable[[Callable[..., R]], Callable[..., R]]:
    """Return a decorator that gives a verb ``--set`` for the files of an argument.

    A verb on cases also gets the shorthands, except those whose name is already an option of the verb.
    """

    def decorate(verb: Callable[..., R]) -> Callable[..., R]:
        parameters = parameters_of(verb)
        own_spellings = {spelling for option in parameters for spelling in _spellings(option)}
        added = [option for option in _options(subject) if not own_spellings & set(_spellings(option))]

        @functools.wraps(verb)
        def run(**options: Any) -> R:
            typed = {option.name: options.pop(option.name, None) for option in added}
            from lineofaction.cli.output import EMPHASIS, console  # noqa: PLC0415 (start-up time)
            from lineofaction.gearbox.project import files_of, sole_file  # noqa: PLC0415 (start-up time)

            named, overrides = options[argument], _overrides(typed)
            several = isinstance(named, list)
            files = []
            for file in named if several else [named]:
                files += [replace(part, overrides=overrides) for part in files_of(file, subject)]
            if several:
                return verb(**options | {argument: files})
            if any(options.get(name) for name in _OF_ONE):
                sole_file(files, named.path, subject)
            for file in files:  # of a folder each of its cases
                if file.part:
                    console().print(f"\n{file.part}", style=EMPHASIS)
                answer = verb(**options | {argument: file})
            return answer

        return with_parameters(run, [*parameters, *added])

    return decorate


def _spellings(option: inspect.Parameter) -> list[str]:
    """Return the spellings of an option; `typer.Option("--a", "-b")` has the first one as `default`."""
    declared = [
        info for info in getattr(option.annotation, "__metadata__", ()) if isinstance(info, OptionInfo)
    ]
    names = [name for info in declared for name in (info.default, *(info.param_decls or ()))]
    spelled = [name for name in names if isinstance(name, str) and name.startswith("-")]
    return spelled or [f"--{option.name.replace('_', '-')}"]


def _overrides(typed: Mapping[str, Any]) -> tuple[Override, ...]:
    """Return the typed options as overrides, shorthands first."""
    made = []
    for name, (path, others) in _SHORTHANDS.items():
        value = typed.get(name)
        if value is not None:
            value = number_list("--torque", value) if name == "torque" else value
            made += [Override(path, value), *(Override(other, None) for other in others)]
    return (*made, *(Override.of(text) for text in typed["overrides"] or ()))
