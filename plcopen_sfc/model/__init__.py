"""The typed model. Knows no file format, no XML and no I/O."""
