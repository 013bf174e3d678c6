"""What joins a project to its files: reading, the source that it keeps, and writing with just the edits in it.

`source` holds what was read, `file` reads and writes one file, `folders` a folder of documents, and `locating` finds
the lines of objects. `storage` loads and saves whatever a path is, and `lowered` proves the code in lowered files.
"""
