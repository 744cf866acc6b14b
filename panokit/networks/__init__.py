"""Network definitions (torch); nothing here is needed to run a released model.

gain_net       log gain on a 128x64 grid, and the camera's curve
component_net  log gain of each burnt-out component
camera         the torch twin of the camera in `panokit.color`
expandnet      ExpandNet as published, to compare with
expansion_net  both, for every picture of a turned panorama, as one network
curve          the torch twin of the response curve in `panokit.expand`
stereo         lighting from two views of an object
"""
