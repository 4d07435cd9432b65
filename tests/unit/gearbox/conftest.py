"""What surrounds the tests of the gearbox."""

from own_directories import own_directories

__all__ = ["own_directories"]
