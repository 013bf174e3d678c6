"""TwinCAT 3: the files of a PLC project (``.TcPOU``), in which TwinCAT keeps one object each.

`twincat_codec`: the files in the table of formats, the objects of a file (`formats.archives`), and tasks.
"""
