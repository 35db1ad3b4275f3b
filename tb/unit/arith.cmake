# Benches of the ALU framework and of the Brh, Flt and Slw ALUs, in Verilator, and a replay
# of some of their results in Icarus.
set(arith_rtl ${RAYPOOL_RTL})
set(arith_unit ${CMAKE_SOURCE_DIR}/tb/unit)

# arith_top(NAME TOP PREFIX PARAMETERS SOURCES...): a bench top of the test program NAME.
function(arith_top name top prefix parameters)
  raypool_verilate(${name} SOURCES ${arith_unit}/${top}.v ${ARGN}
    TOP_MODULE ${top} PREFIX ${prefix} INCLUDE_DIRS ${arith_rtl}
    VERILATOR_ARGS ${parameters} --default-language 1364-2005 -DSYNTHESIS -DNO_CLOCK_GATES -O3 --x-assign fast
    --x-initial fast)
endfunction()

# arith_bench(NAME TOP SOURCES...): the test program NAME of unit/NAME.cpp with the Verilated bench top TOP.
# SYNTHESIS, NO_CLOCK_GATES: with the multipliers and the pipeline registers that hardware has, in whose place whole
# units in simulation have quicker ones. Tests named Long run in `make numerics-long`.
function(arith_bench name top)
  raypool_bench(${name} "-*Long*")
  arith_top(${name} ${top} V${top} "" ${ARGN})
endfunction()

# arith_widths(NAME TOP SOURCES...): the same top with shorter significands, VTOP_20 and so on.
function(arith_widths name top)
  foreach(significand IN ITEMS 20 16 13 11)
    arith_top(${name} ${top} V${top}_${significand} -GSIGNIFICAND=${significand} ${ARGN})
  endforeach()
endfunction()

set(arith_flt_sources ${arith_rtl}/flt_alu.v ${arith_rtl}/float_lane.v ${arith_rtl}/float_adder.v
  ${arith_rtl}/float_multiplier.v ${arith_rtl}/float_convert.v ${arith_rtl}/float_fma.v ${arith_rtl}/multiply_tree.v
  ${arith_rtl}/alu_pipeline.v ${arith_rtl}/alu_delay.v ${arith_rtl}/subnormal_guard.v)
arith_bench(flt_alu_test flt_units ${arith_flt_sources})
arith_widths(flt_alu_test flt_units ${arith_flt_sources})

set(arith_brh_sources ${arith_rtl}/brh_alu.v ${arith_rtl}/alu_pipeline.v ${arith_rtl}/alu_delay.v
  ${arith_rtl}/subnormal_guard.v)
arith_bench(brh_alu_test brh_units ${arith_brh_sources})
arith_widths(brh_alu_test brh_units ${arith_brh_sources})

set(arith_slw_sources ${arith_rtl}/slw_alu.v ${arith_rtl}/slow_lane.v ${arith_rtl}/slow_prepare.v
  ${arith_rtl}/slow_exact.v ${arith_rtl}/slow_newton.v ${arith_rtl}/slow_refine.v ${arith_rtl}/slow_line_table.v
  ${arith_rtl}/slow_seed_table.v ${arith_rtl}/multiply_tree.v ${arith_rtl}/alu_pipeline.v ${arith_rtl}/alu_delay.v
  ${arith_rtl}/subnormal_guard.v)
arith_bench(slw_alu_test slw_units ${arith_slw_sources})
raypool_large_bench(slw_alu 300 --gtest_filter=-*Long*)
arith_widths(slw_alu_large_test slw_units ${arith_slw_sources})
arith_top(slw_alu_test slw_group_units Vslw_group_units "" ${arith_slw_sources})

# ALUs that lack instructions.
set(arith_all_sources ${arith_brh_sources} ${arith_rtl}/int_alu.v ${arith_flt_sources} ${arith_slw_sources})
list(REMOVE_DUPLICATES arith_all_sources)
arith_bench(left_out_test left_out_units ${arith_all_sources})
arith_top(left_out_test left_out_units Vleft_out_units_short "-GSIGNIFICAND=16;-GSUBNORMALS=1;-GSLOW_UNIT=1"
  ${arith_all_sources})

# ALUs that watch for subnormal numbers.
arith_bench(subnormal_guard_test guard_units ${arith_all_sources})
arith_top(subnormal_guard_test guard_units Vguard_units_13 -GSIGNIFICAND=13 ${arith_all_sources})

arith_bench(alu_pipeline_test pipeline_units ${arith_rtl}/alu_pipeline.v)

# Icarus: the same sources in a second simulator, for the modes that differ most.
find_program(IVERILOG iverilog)
find_program(VVP vvp)
if(IVERILOG AND VVP)
  add_executable(arith_vectors ${arith_unit}/arith_vectors.cpp)
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
    set(sources ${arith_brh_sources} ${arith_flt_sources} ${arith_slw_sources})
    list(REMOVE_DUPLICATES sources)
    add_custom_command(OUTPUT ${program}
      COMMAND ${IVERILOG} -g2005 -Wall -I ${arith_rtl} -s arith_icarus -Parith_icarus.SUBNORMALS=${subnormals}
        -Parith_icarus.SLOW_UNIT=${slow_unit} -Parith_icarus.FMA=${fma}
        -Parith_icarus.SIGNIFICAND=${significand} -o ${program} ${arith_unit}/arith_icarus.v ${sources}
      DEPENDS ${arith_unit}/arith_icarus.v ${sources} ${arith_rtl}/isa.vh ${arith_rtl}/booth_digits.vh
        ${arith_rtl}/ones_below.vh ${arith_rtl}/free_running.vh VERBATIM)
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
raypool_bench(small_floats_test "-*Long*:*Hours*")
foreach(format IN ITEMS "16 5 10" "8 4 3")
  separate_arguments(format)
  list(GET format 0 bits)
  list(GET format 1 exponent)
  list(GET format 2 mantissa)
  raypool_verilate(small_floats_test SOURCES ${arith_unit}/small_floats.v ${arith_rtl}/float_adder.v
    ${arith_rtl}/float_multiplier.v ${arith_rtl}/float_fma.v ${arith_rtl}/multiply_tree.v
    TOP_MODULE small_floats PREFIX Vsmall_floats_${bits} INCLUDE_DIRS ${arith_rtl}
    VERILATOR_ARGS --default-language 1364-2005 -DSYNTHESIS -DNO_CLOCK_GATES -O3 --x-assign fast --x-initial fast
    -GEXPONENT_BITS=${exponent} -GMANTISSA_BITS=${mantissa})
endforeach()
# Products of every pair of 16-bit numbers: with the tree that hardware has, and with
# the simulator's product in its place.
foreach(tree IN ITEMS "tree -DSYNTHESIS" "quick")
  separate_arguments(tree)
  list(POP_FRONT tree name)
  raypool_verilate(small_floats_test SOURCES ${arith_unit}/small_products.v ${arith_rtl}/float_multiplier.v
    ${arith_rtl}/multiply_tree.v
    TOP_MODULE small_products PREFIX Vsmall_products_${name} INCLUDE_DIRS ${arith_rtl}
    VERILATOR_ARGS --default-language 1364-2005 ${tree} -O3 --x-assign fast --x-initial fast)
endforeach()
raypool_verilate(small_floats_test SOURCES ${arith_rtl}/multiply_tree.v
  TOP_MODULE multiply_tree PREFIX Vmultiply_tree_11 INCLUDE_DIRS ${arith_rtl}
  VERILATOR_ARGS --default-language 1364-2005 -DSYNTHESIS -O3 -GA_BITS=11 -GB_BITS=11)
