"""Networks that read the light of a scene from two views of an object (torch).

settings    which of them: everything that the 2018 thesis compared, as one set of choices
blocks      the two blocks that all of them are made of
similarity  how alike the two views are, place by place or along rows
net         the network
reflectance networks from reflectance maps, and from a picture to one
sparse      the torch twin of the sparse reflectance map
coding      the torch twin of the HDR coding
"""
