"""What surrounds the tests of hard cases."""

from own_directories import own_directories
from service_surroundings import workers_find_fakes

__all__ = ["own_directories", "workers_find_fakes"]
