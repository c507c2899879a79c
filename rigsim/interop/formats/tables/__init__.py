"""The tables of rig.toml, as models."""
