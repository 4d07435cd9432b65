"""First case and scene files, from few arguments: rules for what is not given, and their text."""
