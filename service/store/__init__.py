"""What is kept: a database, and content-addressed result files."""

from service.store.database import now, open_database, reading, writing
from service.store.dialects import dialect_of
from service.store.directory import DirectoryLock, identity_of
from service.store.outages import retried
from service.store.results import DATABASE_FILE, RESULTS_DIRECTORY, ResultStore, StoredResult, stored_results

__all__ = [
    "DATABASE_FILE",
    "RESULTS_DIRECTORY",
    "DirectoryLock",
    "ResultStore",
    "StoredResult",
    "dialect_of",
    "identity_of",
    "now",
    "open_database",
    "reading",
    "retried",
    "stored_results",
    "writing",
]
