"""Exports of CODESYS V3 in its own format (``.export``): Project > Export.

* `export_codec`: the files in the table of formats, read and written
* `export_entries`: the objects of a file, as the elements that `formats.archives` reads, and back; tasks
* `export_notation`: archives of objects in the words of these files, and texts line by line
"""
