"""The command line ``loa``."""

from lineofaction.cli.commands import main

__all__ = ["main"]
