"""The live page: controls, pictures and numbers that follow each other; every number is made elsewhere.

`pages` lays out each page, `logic` turns a page's words into answers without any browser, `kit` is what pages
share, `draw` renders and proves in processes of their own. Only this room imports nicegui.
"""
