"""The sea: spectra, waves over time, and the forces they excite."""
