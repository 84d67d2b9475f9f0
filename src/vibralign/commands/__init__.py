"""The command ``vibralign``: a module for each of its commands."""
