"""Edits of a project that keep every reference right."""
