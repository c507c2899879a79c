"""Whether witnesses agree: the tests, and what they decide."""
