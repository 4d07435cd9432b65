"""What a report shows of tables and flanks."""
