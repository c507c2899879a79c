"""
What the rig sees
=================

A bundled scene, rendered by the two cameras, with the exact depth of each pixel.
"""

import matplotlib.pyplot as plt

import rigsim

lens = rigsim.Intrinsics.from_hfov(480, 360, hfov_deg=70)
rig = rigsim.StereoRig.rectified(lens, baseline_m=0.12)
with rigsim.Simulator("artifact") as simulator:
    simulator.place(rig)
    frame = simulator.render()

figure, axes = plt.subplots(1, 3, figsize=(12, 3.4), layout="constrained")
axes[0].imshow(frame.left.image)
axes[1].imshow(frame.right.image)
depth = axes[2].imshow(frame.left.depth, cmap="viridis_r")
figure.colorbar(depth, ax=axes[2], label="m")
for panel, title in zip(axes, ("left", "right", "depth of the left image"), strict=True):
    panel.set(title=title, xticks=[], yticks=[])
