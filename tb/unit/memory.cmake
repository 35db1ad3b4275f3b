# Benches of the memory hierarchy: mem_alu (with data_cache and its parts), instruction_cache, memory_arbiter.

# raypool_memory_model(TARGET MODULE SUFFIX PARAMETERS...): class V<module>_<suffix>
function(raypool_memory_model target module suffix)
  list(TRANSFORM ARGN PREPEND -G OUTPUT_VARIABLE parameters)
  raypool_verilate(${target} SOURCES ${RAYPOOL_RTL}/${module}.v PREFIX V${module}_${suffix} TOP_MODULE ${module}
    VERILATOR_ARGS -O3 --default-language 1364-2005 -y ${RAYPOOL_RTL} -I${RAYPOOL_RTL} ${parameters})
endfunction()

raypool_bench(mem_alu_test)
raypool_memory_model(mem_alu_test mem_alu 1x1 WARPS=1 LANES=1 DATA_CACHE_BYTES=512 DATA_CACHE_MSHRS=1)
raypool_memory_model(mem_alu_test mem_alu 4x4 WARPS=4 LANES=4 DATA_CACHE_BYTES=1024 DATA_CACHE_MSHRS=2)
raypool_memory_model(mem_alu_test mem_alu 8x8 WARPS=8 LANES=8 DATA_CACHE_BYTES=8192 DATA_CACHE_MSHRS=4)
raypool_memory_model(mem_alu_test mem_alu 8x8_small WARPS=8 LANES=8 DATA_CACHE_BYTES=512 DATA_CACHE_MSHRS=1)
raypool_memory_model(mem_alu_test mem_alu 1x32 WARPS=1 LANES=32 DATA_CACHE_BYTES=1024 DATA_CACHE_MSHRS=4)
raypool_memory_model(mem_alu_test mem_alu 16x4 WARPS=16 LANES=4 DATA_CACHE_BYTES=512 DATA_CACHE_MSHRS=16)
raypool_memory_model(mem_alu_test mem_alu 32x2 WARPS=32 LANES=2 DATA_CACHE_BYTES=512 DATA_CACHE_MSHRS=3)

raypool_bench(instruction_cache_test)
raypool_memory_model(instruction_cache_test instruction_cache 1w WARPS=1 INSTRUCTION_CACHE_BYTES=512)
raypool_memory_model(instruction_cache_test instruction_cache 8w WARPS=8 INSTRUCTION_CACHE_BYTES=4096)
raypool_memory_model(instruction_cache_test instruction_cache 32w WARPS=32 INSTRUCTION_CACHE_BYTES=512)

raypool_bench(memory_arbiter_test)
raypool_memory_model(memory_arbiter_test memory_arbiter unit)
