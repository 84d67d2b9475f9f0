"""Answers on an engineer's device: assessment, design, yield, maps, and what they assume."""
