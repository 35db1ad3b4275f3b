# Bench of what stands between the units of a multiprocessor: class V<module>_<units>.
raypool_bench(arbiters_test)
function(raypool_arbiter_model module units)
  raypool_verilate(arbiters_test SOURCES ${RAYPOOL_RTL}/${module}.v PREFIX V${module}_${units} TOP_MODULE ${module}
    VERILATOR_ARGS -O3 --default-language 1364-2005 -y ${RAYPOOL_RTL} ${ARGN})
endfunction()
foreach(units 2 3 4)
  raypool_arbiter_model(port_arbiter ${units} -GCOUNT=${units} -GWIDTH=16)
  raypool_arbiter_model(block_scheduler ${units} -GUNITS=${units})
endforeach()
# Packages of five, three and six beats.
raypool_arbiter_model(import_arbiter 2 -GUNITS=2 -GINTERSECTION_WORDS=17)
raypool_arbiter_model(import_arbiter 3 -GUNITS=3 -GINTERSECTION_WORDS=12)
raypool_arbiter_model(import_arbiter 4 -GUNITS=4)
