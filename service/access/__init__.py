"""Access to the service: keys kept as hashes, rates of requests."""

from service.access.key_file import AccessKey, KeyFile
from service.access.keyring import Keyring, open_keyring
from service.access.rate_limit import RateLimits

__all__ = ["AccessKey", "KeyFile", "Keyring", "RateLimits", "open_keyring"]
