"""What is kept: one SQLite file and content-addressed result files."""

from service.store.database import now, open_database, reading, writing
from service.store.directory import DirectoryLock
from service.store.results import DATABASE_FILE, RESULTS_DIRECTORY, ResultStore, StoredResult, stored_results

__all__ = [
    "DATABASE_FILE",
    "RESULTS_DIRECTORY",
    "DirectoryLock",
    "ResultStore",
    "StoredResult",
    "now",
    "open_database",
    "reading",
    "stored_results",
    "writing",
]
