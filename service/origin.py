"""Origins of addresses on the network (RFC 6454): scheme, host and port."""

from __future__ import annotations

import ipaddress
from contextlib import suppress
from dataclasses import dataclass
from typing import Self
from urllib.parse import urlsplit

_PORTS = {"http": 80, "https": 443}


@dataclass(frozen=True)
class Origin:
    """Scheme, host in lower case, and port."""

    scheme: str
    host: str
    port: int

    @classmethod
    def of(cls, uri: str) -> Self:
        """Return the origin of an address.

        Raises `ValueError`: it is not http or https, names no host, or contains a user, a fragment, or
        characters outside printable ASCII.
        """
        parts = urlsplit(uri)
        plain = uri.isascii() and uri.isprintable() and " " not in uri and "\\" not in uri
        if (
            parts.scheme not in _PORTS
            or not parts.hostname
            or "@" in parts.netloc
            or parts.fragment
            or not plain
        ):
            raise ValueError(uri)
        return cls(parts.scheme, parts.hostname, _PORTS[parts.scheme] if parts.port is None else parts.port)

    @property
    def is_address(self) -> bool:
        """Whether the host is written as an address, not as a name."""
        with suppress(ValueError):
            ipaddress.ip_address(self.host)
            return True
        return False

    def __str__(self) -> str:
        host = f"[{self.host}]" if ":" in self.host else self.host
        return f"{self.scheme}://{host}:{self.port}"


def is_loopback(host: str) -> bool:
    """Whether a host, by its name or address, is this machine and reached from nowhere else."""
    with suppress(ValueError):
        return host == "localhost" or ipaddress.ip_address(host).is_loopback
    return False
