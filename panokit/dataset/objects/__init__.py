"""The objects: procedural furniture without end, and folders of meshes."""
