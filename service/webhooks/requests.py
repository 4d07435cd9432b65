"""One request to a receiver: to an address that may be called, bounded in time, redirects not followed."""

from __future__ import annotations

import http.client
import ipaddress
import socket
import ssl
import threading
from collections.abc import Mapping
from contextlib import closing, suppress
from typing import Any
from urllib.parse import urlsplit

from service.origin import Origin

CONNECTING_S, TOTAL_S = 5.0, 10.0
"""Time to connect, and for the whole exchange."""
_TRANSLATED = ipaddress.ip_network("64:ff9b::/96")


class NotCalled(Exception):
    """A receiver that must not be called, or does not answer; says why."""


def send(uri: str, body: bytes, headers: Mapping[str, str]) -> int:
    """Post a body; return the status of the answer, whose body is not read.

    Raises `NotCalled`: the name has no address that may be called, or no answer comes in time.
    """
    origin = Origin.of(uri)
    try:
        with closing(_connected(origin)) as connection:
            watch = threading.Timer(TOTAL_S, _cut, (connection.sock,))
            watch.start()
            try:
                if isinstance(connection.sock, ssl.SSLSocket):
                    connection.sock.do_handshake()
                parts = urlsplit(uri)
                target = (parts.path or "/") + (f"?{parts.query}" if parts.query else "")
                connection.request("POST", target, body, {"Connection": "close", **headers})
                return connection.getresponse().status
            finally:
                watch.cancel()
    except (OSError, http.client.HTTPException) as error:
        raise NotCalled(f"no answer ({type(error).__name__})") from None


def _connected(origin: Origin) -> http.client.HTTPConnection:
    """Connect to the address that was looked at: the name is not resolved again."""
    family, address = _permitted(origin)
    raw = socket.socket(family, socket.SOCK_STREAM)
    try:
        raw.settimeout(CONNECTING_S)
        raw.connect(address)
        raw.settimeout(TOTAL_S)
        if origin.scheme == "http":
            plain = http.client.HTTPConnection(origin.host, origin.port)
            plain.sock = raw
            return plain
        secure = http.client.HTTPSConnection(origin.host, origin.port)
        context = ssl.create_default_context()
        secure.sock = context.wrap_socket(raw, server_hostname=origin.host, do_handshake_on_connect=False)
        return secure
    except BaseException:
        raw.close()
        raise


def _permitted(origin: Origin) -> tuple[socket.AddressFamily, Any]:
    """Return the first address of an origin that may be called."""
    addresses = socket.getaddrinfo(origin.host, origin.port, type=socket.SOCK_STREAM)
    for family, _, _, _, address in addresses:
        if origin.is_address or is_public(str(address[0])):
            return family, address
    raise NotCalled("the name has no public address; a private one has to be listed as an address")


def is_public(address: str) -> bool:
    """Whether an address is on the public Internet: neither of this machine nor of a private network."""
    parsed = ipaddress.ip_address(address.partition("%")[0])
    if isinstance(parsed, ipaddress.IPv6Address):
        if parsed.ipv4_mapped is not None:
            return is_public(str(parsed.ipv4_mapped))
        if parsed.sixtofour is not None or parsed.teredo is not None or parsed in _TRANSLATED:
            return False
    return parsed.is_global and not parsed.is_multicast


def _cut(connection: socket.socket) -> None:
    """End what takes too long, however slowly it drips."""
    with suppress(OSError):
        connection.shutdown(socket.SHUT_RDWR)
