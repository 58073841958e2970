# SPDX-License-Identifier: MIT
# What only the bench needs: limit kernels, compiled once for each instruction set, and adapters to
# other libraries where they are found. None of it goes into libnacre.
set(bench_levels generic)
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  list(APPEND bench_levels avx2 avx512)
endif()
set(bench_flags_avx2 -mavx2 -mfma -mf16c)
set(bench_flags_avx512 -mavx512f -mavx512bw -mavx512dq -mavx512vl -mavx2 -mfma -mf16c
                       -mprefer-vector-width=512)
foreach(level ${bench_levels})
  add_library(bench_limit_${level} OBJECT bench_limit_bezier.c bench_limit_decode.c
                                          bench_limit_facets.c bench_limit_look_up.c
                                          bench_limit_sampled.c)
  target_link_libraries(bench_limit_${level} PRIVATE ncr_flags)
  target_compile_definitions(bench_limit_${level} PRIVATE BENCH_ISA=${level})
  # A limit has no duty to round alike everywhere: products and sums may fuse.
  target_compile_options(bench_limit_${level} PRIVATE -fopenmp-simd -ffp-contract=fast
                                                      ${bench_flags_${level}})
  target_link_libraries(nacre_command PRIVATE bench_limit_${level})
endforeach()

# OpenSubdiv's own CMake package does not load on Debian 12.
find_path(BENCH_OPENSUBDIV_INCLUDE opensubdiv/bfr/surface.h)
find_library(BENCH_OPENSUBDIV_LIBRARY osdCPU)
find_path(BENCH_NANOFLANN_INCLUDE nanoflann.hpp)
find_path(BENCH_SHARP_INCLUDE libsharp/sharp.h)
find_library(BENCH_SHARP_LIBRARY sharp)
mark_as_advanced(BENCH_OPENSUBDIV_INCLUDE BENCH_OPENSUBDIV_LIBRARY BENCH_NANOFLANN_INCLUDE
                 BENCH_SHARP_INCLUDE BENCH_SHARP_LIBRARY)
set(bench_opensubdiv 0)
set(bench_nanoflann 0)
if(BENCH_OPENSUBDIV_INCLUDE AND BENCH_OPENSUBDIV_LIBRARY)
  set(bench_opensubdiv 1)
  add_library(bench_opensubdiv OBJECT bench_peer_opensubdiv.cpp)
  target_include_directories(bench_opensubdiv SYSTEM PRIVATE ${BENCH_OPENSUBDIV_INCLUDE})
  target_link_libraries(bench_opensubdiv PRIVATE ncr_flags)
  target_link_libraries(nacre_command PRIVATE bench_opensubdiv ${BENCH_OPENSUBDIV_LIBRARY})
endif()
if(BENCH_NANOFLANN_INCLUDE)
  set(bench_nanoflann 1)
  add_library(bench_nanoflann OBJECT bench_peer_nanoflann.cpp)
  target_include_directories(bench_nanoflann SYSTEM PRIVATE ${BENCH_NANOFLANN_INCLUDE})
  target_link_libraries(bench_nanoflann PRIVATE ncr_flags)
  target_link_libraries(nacre_command PRIVATE bench_nanoflann)
endif()
target_compile_definitions(nacre_command PRIVATE BENCH_WITH_OPENSUBDIV=${bench_opensubdiv}
                                                 BENCH_WITH_NANOFLANN=${bench_nanoflann})

# libsharp is under the GPL: a program of its own, which the bench talks to, and which stays where
# it was built.
set(bench_sharp 0)
if(BENCH_SHARP_INCLUDE AND BENCH_SHARP_LIBRARY)
  set(bench_sharp 1)
  add_executable(nacre_peer_sharp bench_peer_sharp.c)
  set_target_properties(nacre_peer_sharp PROPERTIES OUTPUT_NAME nacre-peer-sharp)
  target_include_directories(nacre_peer_sharp SYSTEM PRIVATE ${BENCH_SHARP_INCLUDE})
  target_include_directories(nacre_peer_sharp PRIVATE ${PROJECT_SOURCE_DIR})
  target_link_libraries(nacre_peer_sharp PRIVATE ncr_flags ${BENCH_SHARP_LIBRARY})
endif()
message(STATUS "bench peers: OpenSubdiv ${bench_opensubdiv}, nanoflann ${bench_nanoflann}, "
               "libsharp ${bench_sharp}")
