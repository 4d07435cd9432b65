"""Access to the service: keys kept as hashes, what their holders may do, and how much of it."""

from service.access.capacity import NOBODY, Held, RateLimits
from service.access.identities import Identities, open_identities
from service.access.keyring import EVERY_SCOPE, MEANINGS, AccessKey, Holder, KeyFile, Keyring, Scope

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
