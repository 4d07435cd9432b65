"""What a report shows of housings and their sound."""
