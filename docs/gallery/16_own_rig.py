"""
A rig of one's own, drawn
=========================

Two lenses of 4 mm behind sensors of 3 µm, 200 mm apart and turned in by 5°, with lines of equal depth error.
"""

import rigsim

lens = rigsim.Intrinsics.from_lens(1280, 800, focal_mm=4, sensor_width_mm=3.84)
rig = rigsim.StereoRig.verged(lens, baseline_m=0.2, vergence_deg=5)
figure = rigsim.rig_figure(rig, [[0.0, 0.0, 1.0], [0.3, 0.1, 1.5]], noise_px=0.25)
