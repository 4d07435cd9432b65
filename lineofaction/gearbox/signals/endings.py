"""Formats of recordings: which reader and noun belong to the ending of a file."""

from __future__ import annotations

FORMATS = {
    ".csv": ("csv_table", "a CSV file"),
    ".unv": ("universal", "a universal file"),
    ".uff": ("universal", "a universal file"),
    ".uf": ("universal", "a universal file"),
    ".wav": ("wav", "a WAV file"),
    ".mat": ("matlab", "a MATLAB file"),
    ".h5": ("hdf5", "an HDF5 file"),
    ".hdf5": ("hdf5", "an HDF5 file"),
    ".mf4": ("mdf", "an MDF4 file"),
}
"""Reader and noun of a format, by the ending of the file."""


ENDINGS = tuple(FORMATS)


UNIVERSAL = tuple(ending for ending, (reader, _) in FORMATS.items() if reader == "universal")
"""Endings of universal files."""
