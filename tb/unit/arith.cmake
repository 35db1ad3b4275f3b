# Benches of the ALU framework and of the Brh, Flt and Slw ALUs, in Verilator, and a replay
# of some of their results in Icarus.
set(arith_unit ${CMAKE_SOURCE_DIR}/tb/unit)

# arith_top(NAME TOP PREFIX PARAMETERS...): a bench top of the test program NAME.
function(arith_top name top prefix)
  file(GLOB source ${arith_unit}/*/${top}.v)
  raypool_verilate(${name} SOURCES ${source} TOP_MODULE ${top} PREFIX ${prefix}
    VERILATOR_ARGS ${ARGN} --default-language 1364-2005 -DSYNTHESIS -DNO_CLOCK_GATES -O3 --x-assign fast
    --x-initial fast ${RAYPOOL_RTL_SEARCH})
endfunction()

# arith_bench(NAME TOP): the test program NAME of unit/ROOM/NAME.cpp with the Verilated bench top TOP.
# SYNTHESIS, NO_CLOCK_GATES: with the multipliers and the pipeline registers that hardware has; whole units in
# simulation have quicker ones instead. Tests named Long run in `make numerics-long`.
function(arith_bench name top)
  raypool_bench(${name} EXCEPT *Long*)
  arith_top(${name} ${top} V${top})
endfunction()

# arith_widths(NAME TOP SIGNIFICAND...): the same top with shorter significands, VTOP_20 and so on.
function(arith_widths name top)
  foreach(significand IN LISTS ARGN)
    arith_top(${name} ${top} V${top}_${significand} -GSIGNIFICAND=${significand})
  endforeach()
endfunction()

arith_bench(flt_alu_test flt_units)
arith_widths(flt_alu_test flt_units 11)
raypool_large_bench(flt_alu 60 --gtest_filter=-*Long*)
arith_widths(flt_alu_large_test flt_units 20 16 13)

arith_bench(brh_alu_test brh_units)
arith_widths(brh_alu_test brh_units 20 16 13 11)

arith_bench(slw_alu_test slw_units)
raypool_large_bench(slw_alu 300 --gtest_filter=-*Long*)
arith_widths(slw_alu_large_test slw_units 20 16 13 11)
arith_top(slw_alu_test slw_group_units Vslw_group_units)

# ALUs that lack instructions.
arith_bench(left_out_test left_out_units)
arith_top(left_out_test left_out_units Vleft_out_units_short -GSIGNIFICAND=16 -GSUBNORMALS=1 -GSLOW_UNIT=1)

# ALUs that watch for subnormal numbers.
arith_bench(subnormal_guard_test guard_units)
arith_top(subnormal_guard_test guard_units Vguard_units_13 -GSIGNIFICAND=13)

arith_bench(alu_pipeline_test pipeline_units)

# Icarus: the same sources in a second simulator, for the modes that differ most.
find_program(IVERILOG iverilog)
find_program(VVP vvp)
if(IVERILOG AND VVP)
  file(GLOB sources CONFIGURE_DEPENDS ${RAYPOOL_RTL}/arith/*.v ${RAYPOOL_RTL}/common/*.v ${RAYPOOL_RTL}/compute/*.v)
  file(GLOB headers ${RAYPOOL_RTL}/include/*.vh)
  add_executable(arith_vectors ${arith_unit}/arith/arith_vectors.cpp)
  target_link_libraries(arith_vectors PRIVATE raypool_machine)
  foreach(mode IN ITEMS "0 0 0 24" "1 0 0 24" "0 1 1 24" "1 2 1 24" "0 3 0 24" "0 0 1 16" "1 1 0 11")
    separate_arguments(mode)
    list(GET mode 0 subnormals)
    list(GET mode 1 slow_unit)
    list(GET mode 2 fma)
    list(GET mode 3 significand)
    set(replay arith_icarus_${subnormals}${slow_unit}${fma}_${significand})
    set(program ${CMAKE_CURRENT_BINARY_DIR}/${replay}.vvp)
    set(vectors ${CMAKE_CURRENT_BINARY_DIR}/${replay}.txt)
    add_custom_command(OUTPUT ${program}
      COMMAND ${IVERILOG} -g2005 -Wall -I ${RAYPOOL_RTL}/include -s arith_icarus -Parith_icarus.SUBNORMALS=${subnormals}
        -Parith_icarus.SLOW_UNIT=${slow_unit} -Parith_icarus.FMA=${fma}
        -Parith_icarus.SIGNIFICAND=${significand} -o ${program} ${arith_unit}/arith/arith_icarus.v ${sources}
      DEPENDS ${arith_unit}/arith/arith_icarus.v ${sources} ${headers} VERBATIM)
    add_custom_command(OUTPUT ${vectors}
      COMMAND arith_vectors ${subnormals} ${slow_unit} ${fma} ${significand} 4000 > ${vectors}
      DEPENDS arith_vectors VERBATIM)
    add_custom_target(${replay} ALL DEPENDS ${program} ${vectors})
    add_test(NAME ${replay} COMMAND ${VVP} -n ${program} +vectors=${vectors})
    set_tests_properties(${replay} PROPERTIES PASS_REGULAR_EXPRESSION "results agree" FAIL_REGULAR_EXPRESSION "FAILED")
  endforeach()
endif()

# Narrow formats, against exact integers with all operands there are.
# Tests named Hours run by hand.
raypool_bench(small_floats_test EXCEPT *Long*:*Hours* LONG 6 SmallFloats.EveryTriple*)
foreach(format IN ITEMS "16 5 10" "8 4 3")
  separate_arguments(format)
  list(GET format 0 bits)
  list(GET format 1 exponent)
  list(GET format 2 mantissa)
  raypool_verilate(small_floats_test SOURCES ${arith_unit}/arith/small_floats.v
    TOP_MODULE small_floats PREFIX Vsmall_floats_${bits}
    VERILATOR_ARGS --default-language 1364-2005 -DSYNTHESIS -DNO_CLOCK_GATES -O3 --x-assign fast --x-initial fast
    -GEXPONENT_BITS=${exponent} -GMANTISSA_BITS=${mantissa} ${RAYPOOL_RTL_SEARCH})
endforeach()
# Products of every pair of 16-bit numbers: with the tree that hardware has, and with
# the simulator's product in its place.
foreach(tree IN ITEMS "tree -DSYNTHESIS" "quick")
  separate_arguments(tree)
  list(POP_FRONT tree name)
  raypool_verilate(small_floats_test SOURCES ${arith_unit}/arith/small_products.v
    TOP_MODULE small_products PREFIX Vsmall_products_${name}
    VERILATOR_ARGS --default-language 1364-2005 ${tree} -O3 --x-assign fast --x-initial fast ${RAYPOOL_RTL_SEARCH})
endforeach()
raypool_verilate(small_floats_test SOURCES ${RAYPOOL_RTL}/arith/rp_multiply_tree.v
  TOP_MODULE rp_multiply_tree PREFIX Vmultiply_tree_11
  VERILATOR_ARGS --default-language 1364-2005 -DSYNTHESIS -O3 -GA_BITS=11 -GB_BITS=11 ${RAYPOOL_RTL_SEARCH})
