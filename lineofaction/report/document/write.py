"""From result files to the report: read, draw, write."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from lineofaction.report.document.content import page_of
from lineofaction.report.document.inputs import Inputs, read_inputs
from lineofaction.report.drawing.image import png
from lineofaction.report.drawing.page import Page, html


def write_report(inputs: Path | Sequence[Path], output: Path, images: Path | None = None) -> list[Path]:
    """Write one HTML page that needs no network, and the plots as PNG files.

    Parameters
    ----------
    inputs : Path or sequence of Path
        STE databases, flank results and runs, at most one of each; the file says which it is.
    output : Path
        The page.
    images : Path, optional
        Folder for the PNG files, made if missing; left out: none are written.

    Returns
    -------
    list of Path
        The files written, the page first.

    Raises
    ------
    BadInput
        A file is none of them, is damaged, or there are two of a kind.
    """
    return write_page(read_inputs([inputs] if isinstance(inputs, Path) else list(inputs)), output, images)


def write_page(read: Inputs, output: Path, images: Path | None = None) -> list[Path]:
    """Write the page of what was read; parameters and result are those of `write_report`."""
    return write_whole(page_of(read), output, images)


def write_whole(
    page: Page, output: Path, images: Path | None = None, warnings: Sequence[str] = ()
) -> list[Path]:
    """Write a page from its caller, under what is implausible; parameters as for `write_report`."""
    page = replace(page, alarms=(*(f"Warning: {text}" for text in warnings), *page.alarms))
    drawn = {figure.key: png(figure) for section in page.sections for figure in section.figures}
    _write(output, html(page, drawn).encode("utf-8"))
    written = [output]
    if images is not None:
        images.mkdir(parents=True, exist_ok=True)
        for key, image in drawn.items():
            _write(images / f"{key}.png", image)
            written.append(images / f"{key}.png")
    return written


def _write(path: Path, data: bytes) -> None:
    """Write a file whole or not at all."""
    handle, draft = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.", suffix=".part")
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(data)
        mask = os.umask(0)
        os.umask(mask)
        Path(draft).chmod(0o666 & ~mask)
        Path(draft).replace(path)
    except BaseException:
        Path(draft).unlink(missing_ok=True)
        raise
