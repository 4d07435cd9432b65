"""What a report shows of effects, errors and their cost."""
