"""The batch engine: many runs in the lanes of vectors."""
