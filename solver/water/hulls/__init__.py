"""Bodies that float: buoyancy, radiated and incoming waves, hydrostatics, motions in the frequency domain."""
