"""A folder of documents as one project. See docs/decisions/0012."""
