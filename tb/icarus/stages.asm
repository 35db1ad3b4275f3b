# What docs/images/stages.svg shows, as two warps go through it: two instructions that take the least, one of more
# cycles, a control instruction.
.kernel stages
        tid   r0
        lane  r1
        fmul  r2, r0, r1
        jany  4
        exit
