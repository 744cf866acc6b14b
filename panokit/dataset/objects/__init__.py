"""The objects: procedural furniture without end, and folders of meshes.

catalog   all objects by id
kinds     the kinds of furniture, and the object of a kind and number
seating, cases, vessels   how each kind is made
solids    the closed bodies that they are made of
creases   where a surface is smooth; normals
shaping   sizes, curves, random numbers
folder    meshes from files, with their licenses
"""
