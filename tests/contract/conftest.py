"""The fakes of the service are importable here too."""

from service_surroundings import quiet_log

__all__ = ["quiet_log"]
