"""Renderers behind one protocol, see `panokit.dataset.scene.Renderer`."""
