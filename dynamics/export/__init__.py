"""Runs for other programs: universal file format."""

from dynamics.export.universal_file import FUNCTIONS, write_universal_file

__all__ = ["FUNCTIONS", "write_universal_file"]
