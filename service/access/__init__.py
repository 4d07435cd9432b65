"""Access to the service: keys kept as hashes, what their holders may do, and how much of it."""
