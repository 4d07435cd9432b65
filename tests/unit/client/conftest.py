"""What surrounds the tests of the client, some of whose services run."""

from migrated_once import migrated_once
from own_directories import own_directories
from service_surroundings import quiet_log, unhurried_readiness, workers_find_fakes
from stored_jobs import slept
from warm_once import warm_once, warm_processes

__all__ = [
    "migrated_once",
    "own_directories",
    "quiet_log",
    "slept",
    "unhurried_readiness",
    "warm_once",
    "warm_processes",
    "workers_find_fakes",
]
