"""Pages: projects and what came of them as HTML files that stand alone.

* `project_page`: a project with its charts, declarations, program text, cross references and findings
* `page_index`: anchors of objects, links in program text, places that use an object
* `html_text`: elements and documents; `page_words`: English and German; `page.css` and `page.js` for the browser
"""

from plcopen_sfc.pages.project_page import page

__all__ = ["page"]
