# The sum of 0 .. n-1 by one warp: each lane sums every lanes-th number, then a tree over memory halves the lanes that add.
# The lanes of a warp go in step, so a lane may load what another has stored an instruction before. (Warps do not.)
#   $ raypool run examples/reduction.asm --config 4w4c --threads 4 --arg 1000 --arg 512 --print 512:1
#     00000200: 00079f2c
.kernel reduction
        arg     r0, 0                   # n
        threads r1                      # lanes, a power of two
        tid     r2                      # i
        mov     r3, 0                   # this lane's sum
        ult     p1, r2, r0
  @p1   loop    summed                  # while i < n in any lane
  @p1   iadd    r3, r3, r2
  @p1   iadd    r2, r2, r1
  @p1   ult     p1, r2, r0
summed: tid     r2
        shl     r4, r2, 2
        arg     r5, 1
        iadd    r4, r4, r5              # where this lane's sum stands
        st      [r4], r3

        shr     r1, r1, 1
        ult     p1, r2, r1              # the lower half adds the upper one's
  @p1   loop    done
  @p1   shl     r6, r1, 2
  @p1   iadd    r6, r6, r4
  @p1   ld      r7, [r6]
  @p1   iadd    r3, r3, r7
  @p1   st      [r4], r3
  @p1   shr     r1, r1, 1
  @p1   ult     p1, r2, r1
done:   exit
