"""What a report shows of modes, forced responses and steady states."""
