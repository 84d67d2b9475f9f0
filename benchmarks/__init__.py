"""The package against other methods: for two sections of the report, and for ``make bench``.

Not in the wheel. Methods are compared by their cost at the same true error; true values are the
package's own at a far smaller tolerance.

What both share:

- ``problems``: parameter sets to run, and what a method makes of them
- ``methods``: ways to solve a problem; ``METHODS`` of the report, ``peers`` of ``make bench``
- ``equations``, ``modes``: the peers' own statement of the physics, its modes and events

The report's sections (data and CPU times are made by the workflow):

- ``plans``: what the sections compute, from the configuration
- ``work_precision``: cost against true error, each method from coarse to fine
- ``hard_cases``: every method on scenes that are hard to integrate
- ``fixed_steps``: points of figures that fixed steps get wrong
- ``report``: the sections and their figures

``make bench`` runs in an environment of its own (``.venv-bench``), which the study never needs;
``make bench BENCH_FLAGS=--quick`` gives a rough table. For each method, problem and target it seeks
the loosest tolerance whose true error keeps the target, and times a trajectory there: medians of
rounds in which all methods take turns, compiled code warmed up, on one core. Results: the table on
the terminal, ``results/benchmarks/peers.csv`` with the same numbers, and ``machine.json``.

- ``trajectories``: the problems
- ``equal_error``: the search for the tolerance, and the times
- ``table``: ratios
- ``maps``: maps that follow their boundary against full grids (``--maps`` for these alone)
- ``truth``, ``slot``: alignment and insertion against heyoka and MuJoCo (``make truth``)
"""
