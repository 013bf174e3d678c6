"""Pages: projects and what came of them as HTML files that stand alone.

* `project_page`: a project with its charts, declarations, program text, cross references and findings
* `page_index`: anchors of objects, links in program text, places that use an object
* `timing_diagram`: a trace as a picture, and in the page of its project, to play on the chart
* `html_text`: elements and documents; `page_words`: English and German; `page.css` and `page.js` for the browser
"""

from plcopen_sfc.pages.project_page import page

__all__ = ["page"]
