"""Settings of a run: its outputs, and its integration."""

from dynamics.settings.run import Integration, Outputs

__all__ = ["Integration", "Outputs"]
