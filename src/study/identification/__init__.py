"""The search for the parameters that the paper leaves unstated (decision 19).

``space`` turns unknowns into sweeps, ``candidates`` computes and scores figures at operating
points, ``search`` moves structures, and ``tables`` writes what was found.
"""
