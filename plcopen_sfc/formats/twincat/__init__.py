"""TwinCAT 3: the files of a PLC project (``.TcPOU``), in which TwinCAT keeps one object each.

* `twincat_codec`: the files in the table of formats
* `object_files`: the elements of a file, read and written, their declarations, and tasks; `kept_data`: what is nothing
  in the model
* `archived_charts`: charts, which stand in the file as an archive of objects
* `chart_elements`: the elements of such a chart, declared once for both; `object_archive`: archives as such
"""
