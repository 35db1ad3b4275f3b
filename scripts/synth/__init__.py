"""The synthesis flow: Yosys maps, OpenSTA times, reports are made from their output. docs/use/synthesis.md explains the
results.
"""
