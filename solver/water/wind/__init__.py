"""Wind and current: spectra, coefficients, forces."""
