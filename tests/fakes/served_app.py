"""An application behind a socket, served as `loa serve` serves it, by a thread of this process."""

import socket
import threading
from collections.abc import Iterator
from contextlib import contextmanager

from fastapi import FastAPI
from running_service import until

from lineofaction.cli.connections import http_server


@contextmanager
def served(app: FastAPI) -> Iterator[int]:
    """Serve an app on a free port of loopback while the context lasts."""
    with socket.create_server(("127.0.0.1", 0), backlog=1024) as listener:
        server = http_server(app)
        thread = threading.Thread(target=server.run, kwargs={"sockets": [listener]})
        thread.start()
        try:
            until(lambda: server.started)
            yield listener.getsockname()[1]
        finally:
            server.should_exit = True
            thread.join()
