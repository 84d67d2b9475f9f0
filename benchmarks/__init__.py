"""How fast is vibralign? It and other integrators on the same problems, at equal true error.

``make bench`` runs this in an environment of its own (``.venv-bench``), which the study never
needs; ``make bench BENCH_FLAGS=--quick`` gives a rough table. Results: the table on the terminal,
``results/benchmarks/peers.csv`` with the same numbers, ``machine.json`` with the processor, the
versions, and what is measured besides (peak, start, compilation, cores, settling).

For each method, problem and target the loosest tolerance is sought whose true error keeps the
target; the cost is the CPU time of a trajectory at that tolerance: medians of rounds in which all
methods take turns, compiled code warmed up, on one core. True values are the package's own at a
tolerance of 1e-13; that peers come within 2e-10 of them (3e-12 on W1 to W3) shows that they are
true. An error is the largest over the answers of a case (alignment time, or six states at ten
times), and of the cases that which nine of ten do not exceed.

- ``problems``: what is integrated
- ``equations``: the peers' own statement of the physics, once for every way to compute it
- ``modes``: their modes, switches and restarts, compiled
- ``methods``: a module for each peer
- ``precision``: equal error, and time at it
- ``machine``: what depends on no problem
- ``table``: ratios
- ``maps``: maps that follow their boundary against full grids (``--maps`` for these alone)
"""
