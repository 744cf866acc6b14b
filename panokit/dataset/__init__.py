"""Stereo pairs of unknown objects in known light: scenes, rendering, shards, splits."""
