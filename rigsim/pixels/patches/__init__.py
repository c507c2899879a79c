"""Points of the left picture found again in the right one."""
