"""The Design page: what is feasible, the rig to take, and the rigs that no other beats."""
