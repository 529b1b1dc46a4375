set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)

find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CCACHE_PROGRAM})
endif()

add_library(aligngs_flags INTERFACE)
target_include_directories(aligngs_flags INTERFACE ${CMAKE_SOURCE_DIR}/src)
# Baseline x86-64-v2; wider instruction sets are chosen at run time. No contraction: two passes that
# compile the same expression must get the same bits. errno and trapping are not used by the maths.
target_compile_options(aligngs_flags INTERFACE "$<$<NOT:$<COMPILE_LANGUAGE:CUDA>>:-Wall;-Wextra;-Wshadow;-Wno-unused-parameter;-ffp-contract=off;-fno-math-errno;-fno-trapping-math>")
# CUDA sources: constexpr functions of the library (std::min) on the device too.
target_compile_options(aligngs_flags INTERFACE "$<$<COMPILE_LANGUAGE:CUDA>:--expt-relaxed-constexpr;-Xcompiler=-Wall,-Wextra,-Wno-unused-parameter>")
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # Memory is collected less often: a tenth less time for a third more memory, and the same code.
  target_compile_options(aligngs_flags INTERFACE "$<$<COMPILE_LANGUAGE:CXX>:--param=ggc-min-expand=400>")
  # GCC 12 false alarms in its own string and vector (bugs 105651, 105329)
  target_compile_options(aligngs_flags INTERFACE "$<$<NOT:$<COMPILE_LANGUAGE:CUDA>>:-Wno-restrict;-Wno-stringop-overflow;-Wno-array-bounds>")
endif()
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  target_compile_options(aligngs_flags INTERFACE $<$<NOT:$<COMPILE_LANGUAGE:CUDA>>:-march=x86-64-v2>)
endif()
if(ALIGNGS_SCALAR_ONLY)
  target_compile_definitions(aligngs_flags INTERFACE ALIGNGS_SCALAR_ONLY HWY_COMPILE_ONLY_SCALAR)
endif()
if(ALIGNGS_SANITIZE)
  target_compile_options(aligngs_flags INTERFACE -fsanitize=${ALIGNGS_SANITIZE} -fno-omit-frame-pointer -g1)
  target_link_options(aligngs_flags INTERFACE -fsanitize=${ALIGNGS_SANITIZE})
  if(ALIGNGS_SANITIZE MATCHES "undefined")
    target_compile_options(aligngs_flags INTERFACE -fno-sanitize-recover=undefined)
    if(ALIGNGS_SANITIZE MATCHES "address")
      # The address sanitizer finds what these two find in such code, and a fifth of the time of a build goes into them.
      target_compile_options(aligngs_flags INTERFACE -fno-sanitize=null,object-size)
    endif()
    if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
      # clang 14 cannot assemble its check of function types where there are coroutines
      target_compile_options(aligngs_flags INTERFACE $<$<COMPILE_LANGUAGE:CXX>:-fno-sanitize=function>)
    endif()
  endif()
  # The inner loop of the networks: at -O1 it alone takes a fifth of the time of the sanitized tests.
  set_source_files_properties(${CMAKE_SOURCE_DIR}/src/nn/cpu/panels.cpp PROPERTIES COMPILE_OPTIONS -O2)
endif()
