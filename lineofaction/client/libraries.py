"""The libraries that read results: a client that is installed alone lacks them, and says so."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

_ADVICE = (
    "Results as objects need the libraries: pip uninstall lineofaction-client, pip install lineofaction. "
    "job.figures(), job.report() and job.file() do not."
)


@contextmanager
def libraries() -> Iterator[None]:
    """Say what to install where the body imports what is not here.

    Raises
    ------
    ModuleNotFoundError
        With the package to install; `host.extras.MissingExtra`, which names its extra, as it is.
    """
    try:
        yield
    except ModuleNotFoundError as error:
        if type(error) is not ModuleNotFoundError:
            raise
        raise ModuleNotFoundError(f"{error.name} is not installed. {_ADVICE}", name=error.name) from None
