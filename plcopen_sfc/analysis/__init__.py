"""What can be said about a chart without running it: markings, structure, exclusive conditions."""
