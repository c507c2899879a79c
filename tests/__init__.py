"""The tests; a folder a room or use case, and what they share in helpers."""
