"""The HTML report of QA, one file without any external request, and qa.json beside it.

html      the page engine: templates, pictures as data URIs; knows nothing of QA
pictures  what a map looks like: bracket, tone mapping, false color, balls
accuracy  how near to its reference a map is
words     what QA found out, in words
cards     a judged map as a card of the page
write     `write_report`
"""
