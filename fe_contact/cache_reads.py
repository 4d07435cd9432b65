"""Counts of the reads of a cache in this process: how many found their entry, and how many did not."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass
class CacheReads:
    """Reads of a cache since the process began.

    `hits`, `misses`: reads that found what they looked for, whole; reads that did not.
    """

    hits: int = 0
    misses: int = 0

    def note(self, *, hit: bool) -> None:
        """Count one read of the cache."""
        self.hits += hit
        self.misses += not hit


COMPLIANCE_READS = CacheReads()
"""Counts of the cache of compliances and root stresses."""
