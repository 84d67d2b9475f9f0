"""Three-dimensional reference for a round peg in a round hole; shares no code with ``model``."""
