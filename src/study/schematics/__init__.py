"""Figs. 1 to 4 of the paper, drawn from the model's own geometry and parameters.

Part and slot are exactly where ``model.physics.geometry`` puts them. Only two things are enlarged:
the tilt, which at the start is far too small to see, and in Fig. 4 the depths d and w.
"""

from study.schematics import fig01, fig02, fig03, fig04

DRAWINGS = {"fig01": fig01.draw, "fig02": fig02.draw, "fig03": fig03.draw, "fig04": fig04.draw}
