"""The page of the service: its files and the cases it offers to begin with."""
