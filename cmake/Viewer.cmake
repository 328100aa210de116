# The results page: target isochor_view. Include once, from the top-level CMakeLists.txt, after project().
#
#   ISOCHOR_RESULTS_PAGE  ON: bundle the page with node and npm when they are found (default). OFF: the library
#                         is built without it and results_page_available() returns false.

option(ISOCHOR_RESULTS_PAGE "Bundle the HTML results page (needs node and npm)" ON)

find_package(ZLIB REQUIRED)
find_program(ISOCHOR_NODE node)
find_program(ISOCHOR_NPM npm)
mark_as_advanced(ISOCHOR_NODE ISOCHOR_NPM)

set(_view_dir "${CMAKE_CURRENT_LIST_DIR}/../viewer")
get_filename_component(_view_dir "${_view_dir}" ABSOLUTE)
set(_view_work "${CMAKE_BINARY_DIR}/viewer-web")
set(_view_template "${_view_work}/results_template.cpp")

if(ISOCHOR_RESULTS_PAGE AND ISOCHOR_NODE AND ISOCHOR_NPM)
  set(_view_tools "-DNODE=${ISOCHOR_NODE}" "-DNPM=${ISOCHOR_NPM}")
else()
  set(_view_tools "")
  message(STATUS "Results page: left out (ISOCHOR_RESULTS_PAGE is off, or node or npm was not found)")
endif()

file(GLOB_RECURSE _view_web CONFIGURE_DEPENDS "${_view_dir}/web/src/*")
file(MAKE_DIRECTORY "${_view_work}")
if(EXISTS "${_view_work}/missing.txt")
  file(REMOVE "${_view_template}" "${_view_work}/missing.txt")
endif()
# Written only when it differs: a new choice of tools rebuilds the page, a repeated configure does not.
file(CONFIGURE OUTPUT "${_view_work}/tools.txt" CONTENT "${_view_tools}\n")
add_custom_command(
  OUTPUT "${_view_template}"
  COMMAND "${CMAKE_COMMAND}" "-DSOURCE_DIR=${_view_dir}/web" "-DWORK_DIR=${_view_work}"
          "-DOUTPUT=${_view_template}" ${_view_tools} -P "${_view_dir}/web/embed.cmake"
  DEPENDS ${_view_web} "${_view_dir}/web/package.json" "${_view_dir}/web/package-lock.json"
          "${_view_dir}/web/build.mjs" "${_view_dir}/web/embed.cmake" "${_view_work}/tools.txt"
  COMMENT "Bundling the results page"
  VERBATIM)

file(GLOB _view_sources CONFIGURE_DEPENDS "${_view_dir}/*.cpp")
add_library(isochor_view STATIC ${_view_sources} "${_view_template}")
target_include_directories(isochor_view PUBLIC $<BUILD_INTERFACE:${_view_dir}> $<BUILD_INTERFACE:${_view_dir}/../include>)
target_compile_features(isochor_view PUBLIC cxx_std_20)
set_target_properties(isochor_view PROPERTIES POSITION_INDEPENDENT_CODE ON)
target_link_libraries(isochor_view PRIVATE ZLIB::ZLIB)
