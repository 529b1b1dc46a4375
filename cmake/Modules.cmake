set_property(GLOBAL PROPERTY ALIGNGS_MODULES "")

# Half of the time of a first build goes into templates of other libraries, which each source needs again. A change of one
# source costs the time of its whole unit, so that this is for builds that nobody works in.
option(ALIGNGS_UNITY_BUILD "Compile several sources of a module at once: a first build takes half the time" OFF)
set(ALIGNGS_UNITY_GROUP "" CACHE STRING "Sources in each group of a unity build, 0 for all of a module: otherwise as chosen here")

# aligngs_together(TARGET count): lets unity builds compile so many sources of TARGET at once. Sources for one instruction
# set, or that include themselves for each (Highway's foreach_target.h), are compiled alone.
function(aligngs_together target count)
  if(NOT ALIGNGS_UNITY_BUILD)
    return()
  endif()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE ${count})
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # GCC takes a source that another includes for a header, where anonymous namespaces would be a fault.
    target_compile_options(${target} PRIVATE $<$<COMPILE_LANGUAGE:CXX>:-Wno-subobject-linkage>)
  endif()
  get_target_property(sources ${target} SOURCES)
  foreach(file IN LISTS sources)
    file(STRINGS ${file} per_target REGEX "foreach_target|__attribute__\\(\\(target|GCC target")
    if(per_target)
      set_source_files_properties(${file} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
    endif()
  endforeach()
endfunction()

# aligngs_module(NAME [TOGETHER] [GROUP count] [HEAVY expression] LIBRARIES ...): a static library of src/NAME/**/*.cpp.
# TOGETHER lets unity builds compile its sources in groups: names in their anonymous namespaces must differ. A group has
# twenty sources unless GROUP has another count: fewer where a unit would need more than a gigabyte of memory, or where
# a change of one source should cost little. Files with a line that HEAVY matches, the include of a large header, come
# first, so that few groups read it. The tests beside the sources are collected in tests/CMakeLists.txt, one program
# per module. cuda/ folders: cmake/Cuda.cmake.
function(aligngs_module name)
  cmake_parse_arguments(ARG "TOGETHER" "GROUP;HEAVY" "LIBRARIES" ${ARGN})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/src/${name}/*.cpp)
  list(FILTER sources EXCLUDE REGEX "_test\\.cpp$|/src/[a-z]+/cuda/")
  if(ARG_HEAVY)
    set(heavy)
    foreach(file IN LISTS sources)
      file(STRINGS ${file} lines REGEX "${ARG_HEAVY}")
      if(lines)
        list(APPEND heavy ${file})
      endif()
    endforeach()
    list(REMOVE_ITEM sources ${heavy})
    list(PREPEND sources ${heavy})
  endif()
  if(NOT ALIGNGS_UNITY_GROUP STREQUAL "")
    set(ARG_GROUP ${ALIGNGS_UNITY_GROUP})
  elseif(NOT ARG_GROUP)
    set(ARG_GROUP 20)
  endif()
  if(sources)
    add_library(aligngs_${name} STATIC ${sources})
    if(ARG_TOGETHER)
      aligngs_together(aligngs_${name} ${ARG_GROUP})
    endif()
    target_link_libraries(aligngs_${name} PUBLIC aligngs_flags ${ARG_LIBRARIES})
  else()
    add_library(aligngs_${name} INTERFACE)
    target_link_libraries(aligngs_${name} INTERFACE aligngs_flags ${ARG_LIBRARIES})
  endif()
  set_property(GLOBAL APPEND PROPERTY ALIGNGS_MODULES ${name})
endfunction()
