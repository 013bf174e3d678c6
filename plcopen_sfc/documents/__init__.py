"""Projects and their files: reading, the source that a project keeps, and writing with just the edits in it.

* `storage`: loads and saves a path, whatever it is. `lowered`: proves the code in lowered files.
* `file_documents`: one file; `writer_preparation`: a project in the terms of the format to write.
* `folder_projects`: a folder of documents as one project; `folder_documents`: its documents and their names.
* `picture_files`: pictures of the charts of a project, in files.
* `sources`: what a project was read from, and the lines of its objects.
"""
