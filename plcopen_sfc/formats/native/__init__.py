"""Our own format: the model as JSON."""
