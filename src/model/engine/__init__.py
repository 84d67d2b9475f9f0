"""The engine: it integrates runs from event to event."""
