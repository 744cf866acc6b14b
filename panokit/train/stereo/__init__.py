"""Training of networks that read light from two views of an object.

recipe   everything that decides a model
pack     a dataset's split as arrays that a step can be cut from
tasks    what each kind of network is given, and what it is to give
losses   how wrong a predicted map is
loop     the loop: epochs, validation, the history
release  from a trained network to the files of a model
stage    `panokit train` for such recipes
"""
