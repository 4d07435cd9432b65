"""Arguments and help of the verb on the machine itself."""

from __future__ import annotations

from typing import TYPE_CHECKING

import typer

from lineofaction.cli.guard import guarded
from lineofaction.cli.options import AsJson
from lineofaction.cli.verbs import Later

if TYPE_CHECKING:
    from lineofaction.cli import doctor
else:
    doctor = Later("cli.doctor")

verbs = typer.Typer()


@verbs.command("doctor", rich_help_panel="start", epilog="Example: loa doctor")
@guarded
def _doctor(json: AsJson = False) -> None:
    """Say what this machine and installation lack, and which verbs work."""
    from lineofaction.cli.commands import verb_names  # noqa: PLC0415 (it imports this file)

    doctor.run_doctor(verb_names(), as_json=json)
