# Threads that part: steps of the Collatz sequence from i + 1 down to 1, another number in every thread. Within the loop a
# predicate chooses what a thread does; the warp goes on until its last thread is done.
#   $ raypool run examples/divergence.asm --config 4w4c --threads 16 --arg 512 --print 512:16
#     00000200: 00000000 00000001 00000007 00000002 00000005 00000008 00000010 00000003
#     00000220: 00000013 00000006 0000000e 00000009 00000009 00000011 00000011 00000004
.kernel divergence
        tid     r0
        iadd    r1, r0, 1               # x
        mov     r2, 0                   # steps
        ine     p1, r1, 1
  @p1   loop    done                    # while x != 1 in any thread
  @p1   and     r3, r1, 1
  @p1   ieq     p2, r3, 0               # even, and in the loop: a compare's result is ANDed with its mask
  @p1   ine     p3, r3, 0               # odd
  @p2   shr     r1, r1, 1               # x / 2
  @p3   imul    r1, r1, 3               # 3 x + 1
  @p3   iadd    r1, r1, 1
  @p1   iadd    r2, r2, 1
  @p1   ine     p1, r1, 1
done:   shl     r3, r0, 2
        arg     r4, 0
        iadd    r3, r3, r4
        st      [r3], r2
        exit
