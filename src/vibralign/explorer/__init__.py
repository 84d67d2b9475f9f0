"""The explorer: one self-contained page that runs the engine, draws a run and maps outcomes."""
