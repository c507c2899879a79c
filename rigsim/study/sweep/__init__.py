"""Many rigs in one scene."""
