# Every dependency is a Debian 12 package; scripts/setup.sh installs them.
find_package(PkgConfig REQUIRED)
find_package(Threads REQUIRED)
find_package(fmt REQUIRED)
find_package(spdlog REQUIRED)
find_package(Eigen3 3.3 REQUIRED NO_MODULE)
find_package(ZLIB REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(CLI11 REQUIRED)
find_package(Boost 1.74 REQUIRED)  # headers: Asio and Beast
find_package(meshoptimizer REQUIRED)
pkg_check_modules(NANOFLANN REQUIRED IMPORTED_TARGET nanoflann)
add_library(nanoflann::nanoflann ALIAS PkgConfig::NANOFLANN)

pkg_check_modules(TURBOJPEG REQUIRED IMPORTED_TARGET libturbojpeg)
pkg_check_modules(SPNG REQUIRED IMPORTED_TARGET spng)
pkg_check_modules(WEBP REQUIRED IMPORTED_TARGET libwebp)
pkg_check_modules(EXIF REQUIRED IMPORTED_TARGET libexif)
pkg_check_modules(HWY REQUIRED IMPORTED_TARGET libhwy)
pkg_check_modules(TOMLPP REQUIRED IMPORTED_TARGET tomlplusplus)
set(ALIGNGS_IMAGE_LIBRARIES PkgConfig::TURBOJPEG PkgConfig::SPNG PkgConfig::EXIF PkgConfig::WEBP)
add_library(hwy::hwy ALIAS PkgConfig::HWY)
add_library(tomlplusplus::tomlplusplus ALIAS PkgConfig::TOMLPP)

# Debian's embree package ships a CMake config that names no namespaced target; link it by file.
find_library(EMBREE_LIBRARY embree3 REQUIRED)
find_path(EMBREE_INCLUDE_DIR embree3/rtcore.h REQUIRED)

# Optional packages: aligngs_optional(NAME LIBRARIES...) makes the target aligngs_name, which carries the definition
# ALIGNGS_WITH_NAME, and sets ALIGNGS_NAME to it. ALIGNGS_NAME of a missing package is empty, and the parts that need it report it.
function(aligngs_optional name)
  string(TOLOWER ${name} lower)
  add_library(aligngs_${lower} INTERFACE)
  target_link_libraries(aligngs_${lower} INTERFACE ${ARGN})
  target_compile_definitions(aligngs_${lower} INTERFACE ALIGNGS_WITH_${name})
  set(ALIGNGS_${name} aligngs_${lower} PARENT_SCOPE)
endfunction()

# Matrix products of the networks; without it a portable kernel takes over.
if(ALIGNGS_WITH_ONEDNN AND NOT ALIGNGS_SCALAR_ONLY)
  find_library(DNNL_LIBRARY dnnl)
  find_path(DNNL_INCLUDE_DIR dnnl.hpp)
  if(DNNL_LIBRARY AND DNNL_INCLUDE_DIR)
    aligngs_optional(ONEDNN ${DNNL_LIBRARY} ${CMAKE_DL_LIBS})
  endif()
endif()

# Photos of phones: HEIC
pkg_check_modules(HEIF IMPORTED_TARGET QUIET libheif)
if(HEIF_FOUND)
  aligngs_optional(HEIF PkgConfig::HEIF)
endif()

# `aligngs models download`
find_package(CURL 7.61 QUIET)
if(CURL_FOUND)
  aligngs_optional(CURL CURL::libcurl)
endif()
