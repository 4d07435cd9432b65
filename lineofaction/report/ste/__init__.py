"""What a report shows of STE tables."""
