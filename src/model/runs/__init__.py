"""Second floor: runs. One trajectory, or a batch of them on several cores."""
