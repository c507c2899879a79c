"""
The noise behind a data sheet
=============================

Does the error that is claimed grow with the square of the distance, as stereo noise must?
"""

import rigsim

found = rigsim.infer("oak-d", depth_error_pct=[2, 4, 6], at_m=[4, 7, 10.5])
figure = found.figure()
found
