"""The synthesis flow: Yosys maps, OpenSTA times, reports are made from what they say.
docs/use/synthesis.md explains the results.
"""
