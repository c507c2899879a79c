"""What must be held how tightly, and how many built rigs are good."""
