"""The assembled system as plain arrays: what the compiled loops see."""
