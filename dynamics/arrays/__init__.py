"""The assembled system as plain arrays, which the compiled loops read."""
