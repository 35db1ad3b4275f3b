# Benches of the memory hierarchy: mem_alu (with data_cache and its parts), instruction_cache, memory_arbiter.

# raypool_memory_model(TARGET MODULE SUFFIX PARAMETERS...): class V<module>_<suffix>
function(raypool_memory_model target module suffix)
  list(TRANSFORM ARGN PREPEND -G OUTPUT_VARIABLE parameters)
  rtl_file(source ${module})
  raypool_verilate(${target} SOURCES ${source} PREFIX V${module}_${suffix} TOP_MODULE rp_${module}
    VERILATOR_ARGS -O3 --default-language 1364-2005 ${RAYPOOL_RTL_SEARCH} ${parameters})
endfunction()

raypool_bench(mem_alu_test)
raypool_memory_model(mem_alu_test mem_alu 1x1 WARPS=1 LANES=1 DATA_CACHE_BYTES=512 DATA_CACHE_MSHRS=1)
raypool_memory_model(mem_alu_test mem_alu 4x4 WARPS=4 LANES=4 DATA_CACHE_BYTES=1024 DATA_CACHE_MSHRS=2)
raypool_memory_model(mem_alu_test mem_alu 8x8 WARPS=8 LANES=8 DATA_CACHE_BYTES=8192 DATA_CACHE_MSHRS=4)
raypool_memory_model(mem_alu_test mem_alu 8x8_small WARPS=8 LANES=8 DATA_CACHE_BYTES=512 DATA_CACHE_MSHRS=1 SHARING=1)
raypool_memory_model(mem_alu_test mem_alu 1x32 WARPS=1 LANES=32 DATA_CACHE_BYTES=1024 DATA_CACHE_MSHRS=4)
raypool_memory_model(mem_alu_test mem_alu 16x4 WARPS=16 LANES=4 DATA_CACHE_BYTES=512 DATA_CACHE_MSHRS=16 SHARING=1)
raypool_memory_model(mem_alu_test mem_alu 32x2 WARPS=32 LANES=2 DATA_CACHE_BYTES=512 DATA_CACHE_MSHRS=3)

raypool_bench(instruction_cache_test)
raypool_memory_model(instruction_cache_test instruction_cache 1w WARPS=1 INSTRUCTION_CACHE_BYTES=512)
raypool_memory_model(instruction_cache_test instruction_cache 8w WARPS=8 INSTRUCTION_CACHE_BYTES=4096)
raypool_memory_model(instruction_cache_test instruction_cache 32w WARPS=32 INSTRUCTION_CACHE_BYTES=512)

raypool_bench(memory_arbiter_test)
raypool_memory_model(memory_arbiter_test memory_arbiter unit)

# Bench of what stands between the units of a multiprocessor: class V<module>_<units>.
raypool_bench(arbiters_test)
function(raypool_arbiter_model module units)
  rtl_file(source ${module})
  raypool_verilate(arbiters_test SOURCES ${source} PREFIX V${module}_${units} TOP_MODULE rp_${module}
    VERILATOR_ARGS -O3 --default-language 1364-2005 ${RAYPOOL_RTL_SEARCH} ${ARGN})
endfunction()
foreach(units 2 3 4)
  raypool_arbiter_model(port_arbiter ${units} -GCOUNT=${units} -GWIDTH=16)
  raypool_arbiter_model(block_scheduler ${units} -GUNITS=${units})
endforeach()
# Packages of five, three and six beats.
raypool_arbiter_model(import_arbiter 2 -GUNITS=2 -GINTERSECTION_WORDS=17)
raypool_arbiter_model(import_arbiter 3 -GUNITS=3 -GINTERSECTION_WORDS=12)
raypool_arbiter_model(import_arbiter 4 -GUNITS=4)

# Bench of the ray ALU for narrow and wide warps: class Vray_alu_<warps>x<lanes>, with compact records of some words
# Vray_alu_<warps>x<lanes>_<words>words, and with ray memory as wide as the lanes also _wide.
raypool_bench(ray_alu_test)
foreach(size 1x1 2x2 1x32 4x4 8x8 32x1 2x8_wide 1x32_wide 2x2_12words 8x8_16words 2x8_18words_wide)
  string(REGEX MATCH "^([0-9]+)x([0-9]+)(_([0-9]+)words)?(_wide)?$" size ${size})
  set(warps ${CMAKE_MATCH_1})
  set(lanes ${CMAKE_MATCH_2})
  set(words 21)
  if(CMAKE_MATCH_4)
    set(words ${CMAKE_MATCH_4})
  endif()
  if(CMAKE_MATCH_5)
    set(wide 1)
  else()
    set(wide 0)
  endif()
  raypool_verilate(ray_alu_test SOURCES ${RAYPOOL_RTL}/compute/rp_ray_alu.v PREFIX Vray_alu_${size}
    TOP_MODULE rp_ray_alu VERILATOR_ARGS -O3 --default-language 1364-2005 ${RAYPOOL_RTL_SEARCH} -GWARPS=${warps}
    -GLANES=${lanes} -GWIDE_RAY_MEMORY=${wide} -GINTERSECTION_WORDS=${words})
endforeach()
