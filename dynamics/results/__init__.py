"""Results of a run: time series, status, statistics, energy audit, files."""
