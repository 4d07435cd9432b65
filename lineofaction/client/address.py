"""The address of a service, and how HTTP libraries are to reach it."""

from __future__ import annotations

import ipaddress
import os
from typing import Any

import httpx2

from lineofaction.gearbox.problems import BadInput
from service.version import solver_version

DEFAULT = "http://127.0.0.1:8321"


def http_options(base_url: str | None, timeout: float, key: str | None) -> dict[str, Any]:
    """Return the arguments of an httpx2 client, blocking or awaiting, of one service.

    Proxies and certificates are those of the environment (``HTTPS_PROXY``, ``NO_PROXY``, ``SSL_CERT_FILE``);
    this machine is asked without a proxy.

    Parameters
    ----------
    base_url : str, optional
        Default: the environment variable ``LOA_SERVICE``, else ``http://127.0.0.1:8321``.
    timeout : float
        Seconds that connecting, sending, or the next piece of an answer may take.
    key : str, optional
        Access key; default: the environment variable ``LOA_KEY``.

    Raises
    ------
    BadInput
        The address is none.
    """
    address = base_url or os.environ.get("LOA_SERVICE") or DEFAULT
    key = key or os.environ.get("LOA_KEY")
    agent = {"User-Agent": f"lineofaction/{solver_version()}"}
    return {
        "base_url": address.rstrip("/"),
        "headers": agent | ({"Authorization": f"Bearer {key}"} if key else {}),
        "timeout": timeout,
        "trust_env": not _is_loopback(_host(address)),
    }


def _host(base_url: str) -> str:
    """Return the host of an address; raises `BadInput` for one that is none."""
    try:
        url = httpx2.URL(base_url)
    except httpx2.InvalidURL:
        url = httpx2.URL()
    if url.scheme not in ("http", "https") or not url.host:
        advice = "Begin it with http:// or https://."
        raise BadInput.of("service", base_url, "an address such as http://127.0.0.1:8321", advice)
    return url.host


def _is_loopback(host: str) -> bool:
    """Whether a host is this machine, which no proxy needs to reach."""
    try:
        return host == "localhost" or ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False
