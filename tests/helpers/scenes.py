"""Small MJCF scenes whose geometry is known by heart."""

from __future__ import annotations

from pathlib import Path

# the rig sits at (0, 0, 1) and looks along +X; a wall turned by 30 degrees, a post that hides a part of it
SLANTED = """
<mujoco>
  <visual><headlight ambient=".6 .6 .6" diffuse=".3 .3 .3" specular="0 0 0"/></visual>
  <worldbody>
    <site name="rig" pos="0 0 1"/>
    <geom name="wall" type="box" pos="4 0 1" size=".05 6 4" euler="0 0 30" rgba=".6 .5 .4 1"/>
    <geom name="post" type="box" pos="2 .2 1" size=".05 .1 .4" rgba=".2 .4 .8 1"/>
    <body name="head" pos="0 0 1" euler="0 0 90"/>
    <camera name="front" pos="0 0 1" xyaxes="0 -1 0 0 0 1"/>
  </worldbody>
</mujoco>
"""

WALL_NORMAL_WORLD = (-0.8660254037844387, -0.5, 0.0)
"""Outward normal of the wall's face towards the rig: -X turned by 30 degrees about Z."""
WALL_POINT_WORLD = (4 - 0.05 * 0.8660254037844387, -0.05 * 0.5, 1.0)
"""A point of that face."""


def write(folder: Path, xml: str, name: str = "scene_under_test.xml") -> str:
    """Write an MJCF file; returns its path."""
    path = folder / name
    path.write_text(xml)
    return str(path)
