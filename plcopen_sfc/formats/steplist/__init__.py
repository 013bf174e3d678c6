"""Step lists: charts as tables of steps, in workbooks (``xlsx``) and as text (``csv``).

* `list_tables`: the columns, and where in the sheets of a file the tables are.
* `list_reader`, `list_writer`: from tables to a project and back.
* `list_codec`, `xlsx_codec`: the sheets of a text and of a workbook.
"""
