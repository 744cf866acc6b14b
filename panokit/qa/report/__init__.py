"""The report of QA: one HTML file without any external request, and qa.json beside it.

accuracy       how near to its reference a map is
words          what QA found out, in words
cards          a judged map as an entry of the gallery
distributions  the figures of all maps as charts
write          `write_report`; the page itself is made by `panokit.report`
"""
