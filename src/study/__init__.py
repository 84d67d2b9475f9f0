"""The study: its configuration, figures, maps and claims, and the search for the device."""
