"""What a report shows of flanks and roots."""
