"""Second floor: runs. One trajectory, or a batch of them over the cores."""
