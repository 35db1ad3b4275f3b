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
  raypool_verilate(ray_alu_test SOURCES ${RAYPOOL_RTL}/ray_alu.v PREFIX Vray_alu_${size} TOP_MODULE ray_alu
    VERILATOR_ARGS -O3 --default-language 1364-2005 -y ${RAYPOOL_RTL} -I${RAYPOOL_RTL} -GWARPS=${warps}
    -GLANES=${lanes} -GWIDE_RAY_MEMORY=${wide} -GINTERSECTION_WORDS=${words})
endforeach()
