"""The explorer: one self-contained page that runs the engines, draws a run and maps outcomes."""
