"""Rig: what a rig can do, live, with its scene, its pictures and its proof."""

from __future__ import annotations

from rigsim.studio.pages.rig.page import begin as begin
from rigsim.studio.pages.rig.page import build as build
