"""Figures of reports are drawn once in a run of the tests: images are most of what a page costs.

All tests of all workers share the images by what is drawn. The laws of drawing call
`lineofaction.report.drawing.image` itself.
"""

import hashlib
import os
import pickle
from collections.abc import Callable, Iterator
from functools import wraps
from pathlib import Path

import pytest

from lineofaction.report import document
from lineofaction.report.drawing.figure import Figure


@pytest.fixture(scope="module", autouse=True)
def drawn_once(condensed_bodies: Path) -> Iterator[None]:
    """Draw what no report has drawn, and keep it beside the bodies."""
    folder = condensed_bodies.with_name("drawn_figures")
    folder.mkdir(parents=True, exist_ok=True)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(document, "png", _kept(document.png, folder))
        yield


def _kept(draw: Callable[..., bytes], folder: Path) -> Callable[..., bytes]:
    @wraps(draw)
    def found(figure: Figure, *arguments: object, **options: object) -> bytes:
        drawn = figure, arguments, sorted(options.items())
        file = folder / hashlib.sha256(pickle.dumps(drawn)).hexdigest()
        if not file.exists():
            draft = file.with_suffix(f".{os.getpid()}")
            draft.write_bytes(draw(figure, *arguments, **options))
            draft.replace(file)
        return file.read_bytes()

    return found
