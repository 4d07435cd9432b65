"""Settings of a run: what it stores, and how it integrates."""

from dynamics.settings.run import Integration, Outputs

__all__ = ["Integration", "Outputs"]
