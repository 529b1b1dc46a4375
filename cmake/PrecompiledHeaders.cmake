# Headers of others that many sources include, compiled once: without them, half of the time of a build goes into
# reading these headers again. Sources still name every header that they use, and build without this.
option(ALIGNGS_PRECOMPILED_HEADERS "Compile common headers of others once for all sources" ON)

set(ALIGNGS_COMMON_HEADERS <algorithm> <array> <cmath> <cstdint> <cstring> <filesystem> <functional> <limits> <map>
                           <memory> <optional> <string> <string_view> <thread> <utility> <vector>)

# aligngs_precompile(TARGET headers...): the target precompiles the common headers and these.
function(aligngs_precompile target)
  if(ALIGNGS_PRECOMPILED_HEADERS)
    target_precompile_headers(${target} PRIVATE ${ALIGNGS_COMMON_HEADERS} ${ARGN})
    if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
      target_compile_options(${target} PRIVATE $<$<COMPILE_LANGUAGE:CXX>:-fpch-preprocess>)  # for ccache
    endif()
  endif()
endfunction()

# aligngs_share_precompiled(TARGET OWNER): the target takes what OWNER precompiles.
function(aligngs_share_precompiled target owner)
  if(ALIGNGS_PRECOMPILED_HEADERS)
    target_precompile_headers(${target} REUSE_FROM ${owner})
    if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
      target_compile_options(${target} PRIVATE $<$<COMPILE_LANGUAGE:CXX>:-fpch-preprocess>)
    endif()
  endif()
endfunction()

# Sources in which no time is spent when they run: optimised less, they compile faster. GCC 12 has wrong code at -O1 for
# nested conditional sums (src/room/min_cut_test.cpp shows it), which neither -O2 nor -O3 has.
function(aligngs_compile_quickly target)
  if(CMAKE_BUILD_TYPE STREQUAL "Release")
    target_compile_options(${target} PRIVATE $<$<COMPILE_LANGUAGE:CXX>:-O2>)
  endif()
endfunction()

# Such sources are not optimised under clang's sanitizers: they compile in a quarter of the time. They cannot share what
# optimised sources precompile.
function(aligngs_sanitize_quickly target)
  if(ALIGNGS_SANITIZE AND CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
    target_compile_options(${target} PRIVATE $<$<COMPILE_LANGUAGE:CXX>:-O0>)
  endif()
endfunction()

# Tests are not optimised at all: they compile in half of the time. Those that compute much themselves are an exception
# (aligngs_compile_quickly).
function(aligngs_compile_tests target)
  if(CMAKE_BUILD_TYPE STREQUAL "Release")
    target_compile_options(${target} PRIVATE $<$<COMPILE_LANGUAGE:CXX>:-O0>)
  endif()
  aligngs_sanitize_quickly(${target})
endfunction()
