"""What a report shows of studies of designs: sweeps, tolerances, optimization."""
