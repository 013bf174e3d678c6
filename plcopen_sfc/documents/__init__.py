"""Projects and their files: reading, the source that a project keeps, and writing with just the edits in it.

* `storage`: loads and saves a path, whatever it is. `lowered`: proves the code in lowered files.
* `file_documents`: one file; `edited_files`: a file with edits in it. `writer_preparation`: a project in the terms of
  the format to write; `source_names`: its names in the source; `legal_names`: names that the target cannot have;
  `target_differences`: what the target executes otherwise of the same texts; `reading_back`: what was written, read
  again.
* `folder_projects`: a folder of documents as one project; `folder_documents`: its documents and their names.
* `list_merging`: a step list that was edited, merged into the project that it was written from. `name_tables`: new
  names for `rename_many` in tables.
* `picture_files`: pictures of the charts of a project, in files.
* `sources`: what a project was read from, and the lines of its objects.
"""
