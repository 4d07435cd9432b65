"""Access to the service: keys kept as hashes, what their holders may do, and how much of it."""

from service.access.capacity import RateLimits
from service.access.held import NOBODY, Held
from service.access.holder import EVERY_SCOPE, MEANINGS, Holder, Scope
from service.access.identities import Identities, open_identities
from service.access.keyring import AccessKey, KeyFile, Keyring

__all__ = [
    "EVERY_SCOPE",
    "MEANINGS",
    "NOBODY",
    "AccessKey",
    "Held",
    "Holder",
    "Identities",
    "KeyFile",
    "Keyring",
    "RateLimits",
    "Scope",
    "open_identities",
]
