"""Pictures and proofs for the live page, each in a process of its own."""
