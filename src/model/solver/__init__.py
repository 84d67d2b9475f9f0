"""First floor: how the equations are integrated. Methods, steps, switches, the loop, outcomes."""
