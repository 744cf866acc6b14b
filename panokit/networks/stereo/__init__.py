"""Networks that read the light of a scene from two views of an object (torch).

settings    which of them: everything that the 2018 thesis compared, as one set of choices
blocks      the two blocks that all of them are made of
similarity  how alike the two views are, place by place or along rows
window      the background put where the map shows it
lights      a head that says a few lights outright
net         the network, from all of these
reflectance networks from reflectance maps, and from a picture to one
sparse      the torch twin of the sparse reflectance map
coding      the torch twins of the HDR coding and of sRGB
"""
