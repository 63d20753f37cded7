"""The pages of the documentation: those of `docs/`, and those that are made of the code, as plain Markdown.

What is here knows of no program that turns Markdown into a site; `make docs` hands the folder that is made to mkdocs.
"""
