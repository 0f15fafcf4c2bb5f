"""The outside world: case files, stages, results on disk, pictures, the command line.

Attributes
----------
load_case, run_case, load_results
    The three functions of the Python interface; imported on first use, so that
    importing the package stays cheap.
"""
