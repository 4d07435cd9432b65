"""Identity of the sender of a request, by an access key or a token of an OpenID Connect issuer."""

from __future__ import annotations

from typing import Any

from pydantic import ValidationError

from lineofaction.gearbox.problems import BadInput, Unauthorised
from service.access.holder import Holder
from service.access.issuer import Issuer
from service.access.key_file import PREFIX, KeyFile
from service.access.keyring import Keyring
from service.access.tokens import OidcSettings, Tokens, fault_of_error
from service.settings import Settings

Json = dict[str, Any]


class Identities:
    """The callers that a service knows.

    `tokens`: of an issuer; without it there are keys only.
    """

    def __init__(self, keyring: Keyring, tokens: Tokens | None = None) -> None:
        self._keyring, self._tokens = keyring, tokens

    def __bool__(self) -> bool:
        """Whether anybody is known."""
        return self._tokens is not None or bool(self._keyring)

    async def holder(self, presented: str | None) -> Holder:
        """Return who presents a key or a token; raises `Unauthorised`, or as `Tokens.holder`."""
        if presented is None:
            raise Unauthorised("This service asks for an access key, sent as: Authorization: Bearer KEY")
        if self._tokens is not None and not presented.startswith(PREFIX):
            return await self._tokens.holder(presented)
        key = self._keyring.holder(presented)
        if key is None:
            raise Unauthorised.of("This key is unknown. Ask the operator of the service for one.")
        return key


def open_identities(settings: Settings) -> Identities:
    """Return the callers of a service; refuse an address that others can reach as long as nobody is known.

    Raises `BadInput`: the address is not loopback and there are neither keys nor an issuer of tokens, or
    their file or its settings cannot be used.
    """
    try:
        oidc = OidcSettings()
    except ValidationError as error:
        raise BadInput(fault_of_error(dict(item)) for item in error.errors(include_url=False)) from None
    tokens = None if oidc.issuer is None else Tokens(oidc, Issuer(oidc.issuer, oidc.keys_url))
    identities = Identities(Keyring(KeyFile(settings.key_file)), tokens)
    if not settings.loopback and not identities:
        raise BadInput.of(
            "host",
            settings.host,
            "a loopback address such as 127.0.0.1 or ::1, as long as there are no access keys",
            f"Make one with: loa keys add NAME (they are read from {settings.key_file})",
        )
    return identities
