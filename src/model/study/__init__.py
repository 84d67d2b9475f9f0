"""Third floor: the study. Its configuration, sweeps and datasets, and where they came from."""
