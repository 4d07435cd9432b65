"""A process that only serves: the work is done by remote schedulers."""

from __future__ import annotations


class RemoteWork:
    """Stands where the scheduler is in a process that works; others look at the table by themselves."""

    alive = True
    """Nothing here can be dead; whether others work shows in the figures of the table."""
    turn_age_s = 0.0
    """Nothing here can be late."""

    def start(self) -> None:
        """Do nothing."""

    def stop(self) -> None:
        """Do nothing."""

    def wake(self) -> None:
        """Do nothing: remote schedulers look every half second."""
