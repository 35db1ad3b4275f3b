# Benches of the traverser, block by block and whole.

# The traverser's narrow box test. Its oracle counts in rational numbers.
# Of the model's eleven widths `make test` has the narrowest, the default and the widest.
find_library(GMP_LIBRARY gmp REQUIRED)
set(other_widths 1 2 3 4 5 7 8 9)
list(TRANSFORM other_widths PREPEND Bits/Narrow.*/)
raypool_bench(box_pipe_test LONG 20 ${other_widths})
target_link_libraries(box_pipe_test PRIVATE raypool_scene ${GMP_LIBRARY})
raypool_block_models(box_pipe_test box_pipe "BITS" 6 7 10 12 16)

# The edges of its triangle test, against the same oracle.
raypool_bench(triangle_edges_test)
target_link_libraries(triangle_edges_test PRIVATE raypool_scene ${GMP_LIBRARY})
raypool_verilate(triangle_edges_test SOURCES ${RAYPOOL_RTL}/traverser/rp_triangle_edges.v
  PREFIX Vtriangle_edges TOP_MODULE rp_triangle_edges
  VERILATOR_ARGS -O3 --default-language 1364-2005 -DSYNTHESIS ${RAYPOOL_RTL_SEARCH})

# The triangle pipe, with rays that are set up as those of a scene are, and apart from it the multiplier that it has.
raypool_bench(triangle_pipe_test)
target_link_libraries(triangle_pipe_test PRIVATE raypool_scene ${GMP_LIBRARY})
raypool_block_models(triangle_pipe_test float_products "EXPONENT_BITS;MANTISSA_BITS;SUBNORMALS" 11_31_1)
raypool_block_models(triangle_pipe_test float_quotient "EXPONENT_BITS;MANTISSA_BITS" 6_5 11_31)
set(raypool_multiplier)
raypool_block_models(triangle_pipe_test triangle_pipe "BITS" 26 32)
set(raypool_multiplier -DSYNTHESIS)

# The triangle pipe's answers to a corpus of the referee: judged, they are those of the engines with its hits.
add_executable(referee_answers ${CMAKE_CURRENT_LIST_DIR}/traverser/referee_answers.cpp)
target_link_libraries(referee_answers PRIVATE raypool_scene)
set(raypool_multiplier)
raypool_block_models(referee_answers triangle_pipe "BITS" 32)
set(raypool_multiplier -DSYNTHESIS)
raypool_built_test(referee_verilog 50 referee_answers ${CMAKE_SOURCE_DIR}/scripts/tests/referee_verilog.sh
  $<TARGET_FILE:raypool> $<TARGET_FILE:referee_answers>)

# The set-up of a ray, against what engines prepare too.
raypool_bench(ray_setup_test)
target_link_libraries(ray_setup_test PRIVATE raypool_scene ${GMP_LIBRARY})
raypool_block_models(ray_setup_test ray_setup "BITS" 6 12 16)

# The finish of a ray, and what of it can be tried apart.
raypool_bench(ray_finish_test)
target_sources(ray_finish_test PRIVATE ${CMAKE_CURRENT_LIST_DIR}/traverser/ray_finish_parts_test.cpp)
target_link_libraries(ray_finish_test PRIVATE raypool_scene ${GMP_LIBRARY})
raypool_block_models(ray_finish_test ray_finish "TAG_BITS" 16)
raypool_block_models(ray_finish_test cross_products "MANTISSA_BITS" 23 35)
raypool_block_models(ray_finish_test root_digits "DIGITS" 3 15)

# A bank of the traverser's caches.
raypool_bench(tree_cache_test)
raypool_block_models(tree_cache_test tree_cache "LANES;SLOTS;LINES;WAYS;MSHRS;LINE_BITS;DATA_BITS"
  1_1_4_2_1_5_32 3_5_64_4_5_23_32 8_24_128_16_8_23_32 32_2_16_2_3_9_32)

# Such a cache, of banks, with the next lane at each.
raypool_bench(tree_banks_test)
raypool_block_models(tree_banks_test tree_banks "LANES;SLOTS;LINES;WAYS;MSHRS;BANKS;LINE_BITS;DATA_BITS"
  1_2_4_2_1_1_5_32 3_5_64_4_6_2_23_32 16_3_64_2_12_4_20_32 2_9_256_4_16_16_12_32)
raypool_large_bench(tree_banks 150)
raypool_block_models(tree_banks_large_test tree_banks "LANES;SLOTS;LINES;WAYS;MSHRS;BANKS;LINE_BITS;DATA_BITS"
  8_24_1024_16_64_8_26_32 32_2_32_2_4_1_9_32)

# The stacks of a lane of the traverser.
raypool_bench(lane_stacks_test)
raypool_block_models(lane_stacks_test lane_stacks "SLOTS;ENTRIES;KEY_BITS;REFERENCE_BITS;BLOCK_BITS"
  1_8_3_12_7 3_9_21_20_3 5_8_6_10_4 8_12_8_8_7 24_16_32_32_7 33_64_2_9_2)

# A lane of the traverser, with a triangle pipe that uses the simulator's multipliers.
raypool_bench(traverser_lane_test)
target_link_libraries(traverser_lane_test PRIVATE raypool_scene)
set(raypool_multiplier)
set(sizes "SLOTS;ENTRIES;BITS;TRIANGLE_BITS")
raypool_block_models(traverser_lane_test lane_units "${sizes}" 24_16_12_32)
raypool_large_bench(traverser_lane 150)
target_link_libraries(traverser_lane_large_test PRIVATE raypool_scene)
raypool_block_models(traverser_lane_large_test lane_units "${sizes}" 1_8_6_26 3_9_10_30 6_8_16_28)

# The whole traverser.
raypool_bench(traverser_test LONG 30 TraverserTest/*.AgreesInLarge* TraverserTest/*.FaultsThatComeTogether
  TraverserTest/*.ManyRaysWaitForOneLine)
target_link_libraries(traverser_test PRIVATE raypool_scene)
set(sizes "LANES;SLOTS;ENTRIES;BITS;TRIANGLE_PIPES;NODE_LINES;NODE_WAYS;NODE_MSHRS;NODE_BANKS;TRIANGLE_LINES;\
TRIANGLE_WAYS;TRIANGLE_MSHRS;TRIANGLE_BANKS;POOL;RECORD_WORDS;SHADING;CULLING")
raypool_block_models(traverser_test traverser "${sizes}" 3_4_9_10_2_16_2_4_2_32_4_6_2_9_16_1_1)
raypool_block_models(traverser_test traverser "${sizes};MISS_RECORDS" 2_3_8_8_1_16_2_4_2_16_2_2_1_24_21_0_0_1)
raypool_large_bench(traverser 320)
target_link_libraries(traverser_large_test PRIVATE raypool_scene)
raypool_block_models(traverser_large_test traverser "${sizes}"
  1_1_8_6_1_4_2_1_1_4_2_1_1_1_21_0_0 5_24_16_12_1_64_4_16_8_32_2_5_1_160_20_0_1)
set(raypool_multiplier -DSYNTHESIS)
