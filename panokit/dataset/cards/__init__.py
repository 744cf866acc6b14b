"""A dataset for people: its card with histograms and credits, and sheets of samples."""
