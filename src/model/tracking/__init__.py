"""What a job leaves, the index of all runs, and the comparison with the reference."""
