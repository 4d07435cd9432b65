"""What a report shows of runs."""
