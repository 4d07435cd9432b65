"""Fake processes for the tests of the service, importable here and in the workers."""

from postgres_server import database_url, postgres
from s3_server import s3_objects, s3_url
from service_surroundings import quiet_log, unhurried_readiness, workers_find_fakes

__all__ = [
    "database_url",
    "postgres",
    "quiet_log",
    "s3_objects",
    "s3_url",
    "unhurried_readiness",
    "workers_find_fakes",
]
