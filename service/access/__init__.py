"""Access to the service: keys stored as hashes, the rights of their holders, and their limits."""
