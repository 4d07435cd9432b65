"""Fake processes for the tests of the service, importable here and in the workers."""

from migrated_once import migrated_once
from own_directories import own_directories
from postgres_server import database_url, postgres
from s3_server import s3_objects, s3_url
from service_surroundings import client, quiet_log, unhurried_readiness, workers_find_fakes
from study_service import served
from warm_once import warm_once, warm_processes

__all__ = [
    "client",
    "database_url",
    "migrated_once",
    "own_directories",
    "postgres",
    "quiet_log",
    "s3_objects",
    "s3_url",
    "served",
    "unhurried_readiness",
    "warm_once",
    "warm_processes",
    "workers_find_fakes",
]
