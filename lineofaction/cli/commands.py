"""The program ``loa``: its verbs, each of which loads the module that does the work when it is called."""

from __future__ import annotations

import gc
import sys
import warnings
from typing import Annotated, Any

import typer

from host import keep_freed_memory, keep_to_one_thread
from lineofaction.cli.verbs import (
    of_exports,
    of_files,
    of_hard_cases,
    of_housings,
    of_imports,
    of_inspections,
    of_listening,
    of_machine,
    of_pages,
    of_services,
    of_validation,
)
from lineofaction.cli.verbs.of_studies import StudyGroup

_EPILOG = (
    "Start with: loa new -o pair.toml, loa analyze pair.toml -o ste.nc, then loa report ste.nc. "
    "Exit codes: 0 done; 1 a mesh, a solve or a job failed; 2 bad input; 3 warnings under --strict; "
    "4 no service answers; "
    "5 a defect (a log is named); 130 interrupted."
)

FAMILIES = (
    of_files,
    of_exports,
    of_listening,
    of_hard_cases,
    of_validation,
    of_pages,
    of_imports,
    of_inspections,
    of_housings,
    of_services,
    of_machine,
)
"""Modules of verbs, in the order of the help."""

app = typer.Typer(
    name="loa",
    cls=StudyGroup,
    help="Open contact analysis for gear noise: STE databases of gear pairs, and the dynamics they excite.",
    epilog=_EPILOG,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    context_settings={"help_option_names": ["-h", "--help"]},
)
for family in FAMILIES:
    # the list of verbs has the whole first sentence of each docstring, which typer would cut off
    for verb in family.verbs.registered_commands:
        verb.short_help = (verb.callback.__doc__ or "").partition("\n")[0]
    app.add_typer(family.verbs)
app.add_typer(of_services.access_keys, name="keys", rich_help_panel="service")
app.add_typer(of_services.cache, name="cache", rich_help_panel="results")
app.add_typer(of_services.database, name="database", rich_help_panel="service")
app.add_typer(of_services.store, name="store", rich_help_panel="service")


def verb_names() -> list[str]:
    """Return the names of all verbs, those of studies among them."""
    group: Any = typer.main.get_command(app)
    names: list[str] = group.list_commands(None)
    return names


def main() -> None:
    """Run the command line."""
    keep_to_one_thread()
    if sys.argv[1:2] != ["serve"]:  # a server lives on, so it gives back what it has freed
        keep_freed_memory(to_the_end=True)
    # verbs print complaints of plausibility themselves, with the fields and units of the case
    warnings.filterwarnings("ignore", message="implausible")
    foreign = warnings.showwarning

    def show(message: Warning | str, category: type[Warning], *location: Any, **stream: Any) -> None:
        if category.__module__.startswith(("lineofaction.", "service.")):
            typer.echo(f"note: {message}", err=True)
        else:
            foreign(message, category, *location, **stream)

    warnings.showwarning = (
        show  # warnings of this program are notes: a line of source would tell users nothing
    )
    try:
        app()
    finally:
        gc.freeze()  # the last garbage collection skips all objects: they end with the process anyway


def _version(requested: bool) -> None:
    """Print the version and end."""
    if requested:
        from service.version import solver_version  # noqa: PLC0415 (start-up time)

        typer.echo(f"loa {solver_version()}")
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    """Hold the options of all verbs."""
