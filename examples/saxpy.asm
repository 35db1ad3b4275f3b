# y[i] = a x[i] + y[i], an element a thread; x[i] = i and y[i] = 0.5 are written first, by the same thread.
#   $ raypool run examples/saxpy.asm --config 4w4c --blocks 2 --threads 8 --arg 2.0 --arg 512 --arg 1024 --print 1024:16
#     00000400: 3f000000 40200000 40900000 40d00000 41080000 41280000 41480000 41680000
#     00000420: 41840000 41940000 41a40000 41b40000 41c40000 41d40000 41e40000 41f40000
.kernel saxpy
        block   r0
        threads r1
        imul    r0, r0, r1
        tid     r1
        iadd    r0, r0, r1              # i: the thread's number in the grid
        shl     r1, r0, 2               # its offset in bytes
        arg     r2, 1
        iadd    r2, r2, r1              # address of x[i]
        arg     r3, 2
        iadd    r3, r3, r1              # address of y[i]

        i2f     r4, r0
        st      [r2], r4                # x[i] = i
        mov     r5, 0x3f000000          # 0.5
        st      [r3], r5

        arg     r6, 0                   # a
        ld      r4, [r2]
        ld      r5, [r3]
        fmul    r4, r4, r6
        fadd    r5, r5, r4
        st      [r3], r5
        exit
