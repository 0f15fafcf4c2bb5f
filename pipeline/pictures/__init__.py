"""Pictures and plots as PNG: bodies, scenes and histories, rendered without a screen."""
