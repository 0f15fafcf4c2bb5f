"""Cases made, changed and run from Python: classes of components with the keys of a case file, models, results."""
