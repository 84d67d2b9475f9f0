"""Physics of the device: notation, parameters, geometry, contacts, forces, motion."""
