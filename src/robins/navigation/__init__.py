"""Models of moving bodies and their sensors."""
