"""Tables of other flanks on condensed bodies."""
