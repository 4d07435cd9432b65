"""The command line ``loa``."""

from service.cli.commands import main

__all__ = ["main"]
