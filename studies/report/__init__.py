"""The page: sweeps, runs and synthesis reports as one static file, index.html. docs/use/page.md"""
