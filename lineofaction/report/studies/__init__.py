"""What the studies show: a module for each."""
