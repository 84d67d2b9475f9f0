"""Ground floor: what the device is. Notation, parameters, contact geometry, forces, scenes."""
