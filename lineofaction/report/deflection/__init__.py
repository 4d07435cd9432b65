"""What a report shows of a deflected gearbox."""
