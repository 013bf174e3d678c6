"""Step lists: charts as tables of steps, in workbooks (``xlsx``) and as text (``csv``).

* `list_tables`: the columns, and where in the sheets of a file the tables are.
* `list_reader`, `list_writer`: from tables to a project and back.
* `xlsx_codec`, `csv_codec`: the sheets of a workbook and of a text.
"""
