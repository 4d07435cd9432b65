"""Fake processes for the tests of the service, importable here and in the workers."""

from drawn_once import drawn_once
from migrated_once import migrated_once
from own_directories import own_directories
from postgres_server import database_url, postgres
from s3_server import s3_objects, s3_url
from service_surroundings import machine, quiet_log, unhurried_readiness, workers_find_fakes
from stored_jobs import slept
from warm_once import warm_once, warm_processes

__all__ = [
    "database_url",
    "drawn_once",
    "machine",
    "migrated_once",
    "own_directories",
    "postgres",
    "quiet_log",
    "s3_objects",
    "s3_url",
    "slept",
    "unhurried_readiness",
    "warm_once",
    "warm_processes",
    "workers_find_fakes",
]
