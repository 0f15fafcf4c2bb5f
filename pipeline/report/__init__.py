"""The report of a case: sections as data, written as Markdown and HTML."""
