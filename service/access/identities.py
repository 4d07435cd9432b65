"""Who a request comes from, by what it presents."""

from __future__ import annotations

from service.access.holder import Holder
from service.access.key_file import KeyFile
from service.access.keyring import Keyring
from service.problems import BadInput, Unauthorised
from service.settings import Settings


class Identities:
    """The callers that a service knows.

    Parameters
    ----------
    keyring : Keyring
    """

    def __init__(self, keyring: Keyring) -> None:
        self._keyring = keyring

    def __bool__(self) -> bool:
        """Whether anybody is known."""
        return bool(self._keyring)

    async def holder(self, presented: str | None) -> Holder:
        """Return who presents a key; raise `Unauthorised` of what is none, or unknown."""
        if presented is None:
            raise Unauthorised("This service asks for an access key, sent as: Authorization: Bearer KEY")
        key = self._keyring.holder(presented)
        if key is None:
            raise Unauthorised.of("This key is unknown. Ask the operator of the service for one.")
        return key


def open_identities(settings: Settings) -> Identities:
    """Return the callers of a service; refuse an address that others can reach as long as nobody is known.

    Raises
    ------
    BadInput
        The address is not loopback and there are no keys, or their file cannot be used.
    """
    identities = Identities(Keyring(KeyFile(settings.key_file)))
    if not settings.loopback and not identities:
        raise BadInput.of(
            "host",
            settings.host,
            "a loopback address such as 127.0.0.1 or ::1, as long as there are no access keys",
            f"Make one with: loa keys add NAME (they are read from {settings.key_file})",
        )
    return identities
