"""The Python client: typed, synchronous, light (no mesher, no finite elements, no web framework)."""

from service.client.cache import ResultCache
from service.client.client import LineOfActionClient
from service.client.status import JobState, OfflineWarning, Result, Watch

__all__ = ["JobState", "LineOfActionClient", "OfflineWarning", "Result", "ResultCache", "Watch"]
