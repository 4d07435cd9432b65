"""Settings of a run: what it stores, and how it integrates."""

from dynamics.settings.integration import Integration
from dynamics.settings.outputs import Outputs

__all__ = ["Integration", "Outputs"]
