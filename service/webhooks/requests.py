"""A request to the receiver of a webhook: to a permitted address, bounded in time, without redirects.

A host name is called at a public address only: what it resolves to may change, and must not lead into the
service's own network. A receiver in a private network is therefore listed by its address, which is called as
it is.
"""

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
"""Longest time to connect, and longest time of the request and its answer, s."""
_TRANSLATED = ipaddress.ip_network("64:ff9b::/96")
"""IPv6 addresses that a NAT64 gateway translates to IPv4 addresses, private ones included (RFC 6052)."""


class NotCalled(Exception):
    """A receiver must not be called, or it did not answer; the message has the reason."""


def send(uri: str, body: bytes, headers: Mapping[str, str]) -> int:
    """Post a body to `uri`; return the status of the answer, whose body is not read.

    Raises `NotCalled`: the host has no permitted address, or no answer comes in time.
    """
    origin = Origin.of(uri)
    try:
        with closing(_connected(origin)) as connection:
            # the timeout of a socket starts again with each byte: a timer bounds the whole exchange
            watch = threading.Timer(TOTAL_S, _shut_down, (connection.sock,))
            watch.start()
            try:
                if isinstance(connection.sock, ssl.SSLSocket):  # under the timer, too
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
    """Connect to the permitted address.

    The connection gets its socket here: it would resolve the name again, perhaps to another address.
    """
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
    """Return the family and the first permitted address of an origin, as `socket.connect` takes it."""
    addresses = socket.getaddrinfo(origin.host, origin.port, type=socket.SOCK_STREAM)
    for family, _, _, _, address in addresses:
        if origin.is_address or is_public(str(address[0])):
            return family, address
    raise NotCalled("the name has no public address; a private one has to be listed as an address")


def is_public(address: str) -> bool:
    """Whether an address is on the public Internet: neither of this machine nor of a private network."""
    parsed = ipaddress.ip_address(address.partition("%")[0])  # without the zone of an IPv6 address
    if isinstance(parsed, ipaddress.IPv6Address):
        if parsed.ipv4_mapped is not None:
            return is_public(str(parsed.ipv4_mapped))
        # these addresses contain an IPv4 address, which may be private
        if parsed.sixtofour is not None or parsed.teredo is not None or parsed in _TRANSLATED:
            return False
    return parsed.is_global and not parsed.is_multicast


def _shut_down(connection: socket.socket) -> None:
    """Shut a connection down, so that a read that blocks in another thread ends with an error."""
    with suppress(OSError):
        connection.shutdown(socket.SHUT_RDWR)
