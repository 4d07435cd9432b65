"""A disk that takes nothing more: how it shows, and the message of a job."""

from __future__ import annotations

import errno

_FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
"""No space, none left of a quota, none within the largest file a process may write."""


def no_space(error: OSError) -> str:
    """Return the message of a job whose files found no space; empty if that is not what went wrong."""
    if error.errno not in _FULL:
        return ""
    return (
        "The result could not be written: there is no space left in the data directory of the service "
        "(LOA_DATA_DIRECTORY). Make room there, or raise the quota, and submit again."
    )
