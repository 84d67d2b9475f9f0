"""The commands of the study: recorded runs, claims, reference."""
