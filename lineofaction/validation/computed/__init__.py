"""What validation cases compute that no single function or verb answers."""
