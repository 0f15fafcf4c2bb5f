"""Is this lift safe? FEM to flexible multibody dynamics; the folders beside this file are links to the sources."""
