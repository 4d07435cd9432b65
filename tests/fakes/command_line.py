"""The command line, called in this process."""

import json
from typing import Any

from typer.testing import CliRunner, Result

from lineofaction.cli.commands import app


def loa(*arguments: object) -> Result:
    return CliRunner().invoke(app, [*map(str, arguments)])


def printed(*arguments: object) -> Any:
    """Return what a call that succeeds prints as JSON."""
    done = loa(*arguments, "--json")
    assert (done.exit_code, done.stderr) == (0, ""), done.output
    return json.loads(done.stdout)
