"""Events: where a mode of contact ends, and what follows."""
