"""The package against other methods: for two sections of the report, and for ``make bench``.

Not in the wheel. Methods are compared by their cost at the same true error; true values are the
package's own at a far smaller tolerance.

What both share:

- ``problems``: parameter sets to run, and what a method makes of them
- ``methods``: ways to solve a problem; ``METHODS`` of the report, ``peers`` of ``make bench``
- ``equations``: the peers' own statement of the physics, its modes and events
- ``work_precision.climbed``: each method from coarse to fine, the ladder of both

The report's sections (data and CPU times are made by the workflow):

- ``plans``: what the sections compute, from the configuration
- ``work_precision``: cost against true error, each method from coarse to fine
- ``hard_cases``: every method on scenes that are hard to integrate
- ``fixed_steps``: points of figures that fixed steps get wrong
- ``report``: the sections and their figures

``make bench`` runs in an environment of its own (``.venv-bench``), which the study never needs;
``make bench BENCH_FLAGS=--quick`` gives a rough table. Each method climbs the ladder to the first
tolerance whose true error keeps 1e-8, and a trajectory is timed there: medians of rounds in which
all methods take turns, compiled code warmed up, on one core. Results: the table on the terminal,
``results/benchmarks/peers.csv`` with the same numbers, and ``machine.json``.

- ``trajectories``: the problems
- ``table``: settings, times and ratios
- ``maps``: maps that follow their boundary against full grids (``--maps`` for these alone)
- ``truth``, ``slot``: alignment and insertion against heyoka and MuJoCo (``make truth``)
"""
