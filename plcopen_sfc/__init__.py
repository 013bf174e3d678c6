"""Sequential function charts: one typed model, lossless files."""
