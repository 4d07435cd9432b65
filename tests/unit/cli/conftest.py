"""What surrounds the tests of the verbs."""

from drawn_once import drawn_once
from own_directories import own_directories
from service_surroundings import quiet_log, workers_find_fakes

__all__ = ["drawn_once", "own_directories", "quiet_log", "workers_find_fakes"]
