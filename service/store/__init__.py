"""The store: a database, and content-addressed result files."""

from service.folders import DirectoryLock, identity_of
from service.store.database import BRIEF_MS, instant, now, open_database, reading, writing
from service.store.dialects import dialect_of, optional, retried
from service.store.places import DATABASE_FILE, RESULTS_DIRECTORY, result_store, stored_results
from service.store.results import IndexLine, Mark, ResultStore, StoredResult, behind

__all__ = [
    "BRIEF_MS",
    "DATABASE_FILE",
    "RESULTS_DIRECTORY",
    "DirectoryLock",
    "IndexLine",
    "Mark",
    "ResultStore",
    "StoredResult",
    "behind",
    "dialect_of",
    "identity_of",
    "instant",
    "now",
    "open_database",
    "optional",
    "reading",
    "result_store",
    "retried",
    "stored_results",
    "writing",
]
