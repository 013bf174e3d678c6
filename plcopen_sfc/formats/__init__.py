"""File formats, one package each, and the table that registers them."""
