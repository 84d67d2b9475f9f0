"""Engines: integrate runs from event to event."""
