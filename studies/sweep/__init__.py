"""Sweeps: many runs of raypool from one file, by Snakemake. docs/use/sweeps.md"""
