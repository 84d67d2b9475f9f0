"""What turns Python functions into machine code: jit, generated sources, WebAssembly, cache."""
