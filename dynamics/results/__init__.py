"""Results of a run: time series, status, statistics, energy audit, files."""

from dynamics.results.energy_audit import EnergyAudit
from dynamics.results.run_result import RunResult, StepStatistics

__all__ = ["EnergyAudit", "RunResult", "StepStatistics"]
