"""Ground floor, the device: notation, parameters, contact geometry, forces, scenes."""
