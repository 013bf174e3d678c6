"""The faults of textbook forms: what they are and how they are found."""
