"""Whether a request was meant for this machine: what protects a service without keys from pages of others."""

from __future__ import annotations

import ipaddress

from starlette.types import Scope


def meant_for_us(scope: Scope) -> bool:
    """Whether the header Host, if there is one, names this machine or the address that was connected to.

    A page of another site can let its own name point to 127.0.0.1 (DNS rebinding). To a browser the service
    is then part of that site, so that no rule on origins holds the page back; but its name is in Host.
    """
    named = next((value.decode("latin-1") for name, value in scope["headers"] if name == b"host"), None)
    server = scope.get("server")
    if named is None or server is None:
        return True
    host = _without_port(named).lower()
    return host in ("localhost", str(server[0]).lower()) or _is_loopback(host)


def _without_port(host: str) -> str:
    """Return a name or address without its port, and an IPv6 address without its brackets."""
    if host.startswith("["):
        return host[1:].partition("]")[0]
    return host.partition(":")[0]


def _is_loopback(host: str) -> bool:
    """Whether an address is of this machine alone."""
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False
