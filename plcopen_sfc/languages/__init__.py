"""What stands inside bodies: structured text, networks, and the names that both use."""
