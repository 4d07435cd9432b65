"""The libraries that read results: a client that is installed alone lacks them, and says so."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager


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
        advice = "Reading results needs the libraries: pip install lineofaction"
        raise ModuleNotFoundError(f"{error.name} is not installed. {advice}", name=error.name) from None
