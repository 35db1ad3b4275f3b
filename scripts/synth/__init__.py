"""The synthesis flow: Yosys maps, OpenSTA times, reports are made from what they say.
docs/synthesis.md explains the results.
"""
