"""What operators read: health, readiness and metrics of one process, and the port that answers them."""
