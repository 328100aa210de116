# One static library a module; isochor::isochor is all that a host needs. Effects are object files in an archive, so a
# host links only those it names.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

add_library(isochor_options INTERFACE)
target_compile_features(isochor_options INTERFACE cxx_std_20)
target_compile_options(isochor_options INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion
  $<$<BOOL:${ISOCHOR_WERROR}>:-Werror>
  # g++ 12 reports its own AVX intrinsics as uninitialized.
  $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>
  # Sums are written in the order that must hold; contraction to fused multiply-add is the compiler's choice per
  # build, not per thread count.
  $<$<BOOL:${ISOCHOR_NATIVE}>:-march=native>)

# Code around the engine, which runs once a scene: the time that compilers spend on optimizing it is not earned back.
# Not for files that use Eigen's dense algebra: their templates would take the place of the engine's when linked.
function(isochor_compile_quickly target)
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
endfunction()

# isochor_module(name sources...): a static library with the include layout of the tree.
function(isochor_module name)
  add_library(isochor_${name} STATIC ${ARGN})
  add_library(isochor::${name} ALIAS isochor_${name})
  target_include_directories(isochor_${name}
    PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>
    PRIVATE ${PROJECT_SOURCE_DIR})
  target_compile_features(isochor_${name} PUBLIC cxx_std_20)
  target_link_libraries(isochor_${name} PRIVATE $<BUILD_INTERFACE:isochor_options>)
  set_target_properties(isochor_${name} PROPERTIES EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON)
  set_property(GLOBAL APPEND PROPERTY ISOCHOR_MODULES isochor_${name})
endfunction()

function(isochor_sources out)
  set(found)
  foreach(folder ${ARGN})
    file(GLOB here CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/${folder}/*.cpp)
    list(APPEND found ${here})
  endforeach()
  set(${out} ${found} PARENT_SCOPE)
endfunction()

isochor_sources(_base engine/base)
isochor_module(base ${_base})
target_link_libraries(isochor_base PRIVATE TBB::tbb)

isochor_sources(_mesh engine/mesh engine/mesh/read engine/mesh/check engine/mesh/write engine/mesh/make)
isochor_module(mesh ${_mesh})
target_link_libraries(isochor_mesh PUBLIC isochor_base PRIVATE pugixml::pugixml ZLIB::ZLIB)

isochor_sources(_solvers engine/solvers engine/solvers/front engine/solvers/iterative engine/solvers/foreign)
isochor_module(solvers ${_solvers})
target_link_libraries(isochor_solvers PRIVATE Eigen3::Eigen Threads::Threads ${CMAKE_DL_LIBS})
foreach(backend MUMPS CHOLMOD METIS)
  if(ISOCHOR_HAVE_${backend})
    target_compile_definitions(isochor_solvers PRIVATE ISOCHOR_HAVE_${backend})
    target_link_libraries(isochor_solvers PRIVATE ${backend}::${backend})
  endif()
endforeach()

set_property(SOURCE ${PROJECT_SOURCE_DIR}/engine/solvers/linear_solver.cpp APPEND PROPERTY
  COMPILE_DEFINITIONS ISOCHOR_VERSION="${PROJECT_VERSION}")
# Under the GPL, hence apart and only on request.
if(ISOCHOR_HAVE_CHOLMOD_SUPERNODAL)
  isochor_sources(_solvers_gpl engine/solvers/foreign/gpl)
  isochor_module(solvers_gpl ${_solvers_gpl})
  target_link_libraries(isochor_solvers_gpl PRIVATE isochor_solvers CHOLMOD::CHOLMOD)
  set_property(SOURCE ${PROJECT_SOURCE_DIR}/engine/solvers/linear_solver.cpp APPEND PROPERTY
    COMPILE_DEFINITIONS ISOCHOR_HAVE_CHOLMOD_SUPERNODAL)
  target_link_libraries(isochor_solvers PRIVATE isochor_solvers_gpl)
endif()

isochor_sources(_engine engine/math engine/system engine/elements engine/solve engine/solve/newton engine/solve/kkt
  engine/scene engine/step engine/world)
isochor_module(engine ${_engine})
# Square roots set no errno, so that they are taken eight at a time.
set_source_files_properties(${PROJECT_SOURCE_DIR}/engine/math/svd3.cpp PROPERTIES COMPILE_OPTIONS -fno-math-errno)
target_link_libraries(isochor_engine PUBLIC isochor_mesh isochor_solvers PRIVATE Eigen3::Eigen TBB::tbb)

isochor_sources(_materials materials)
isochor_module(materials ${_materials})
target_link_libraries(isochor_materials PUBLIC isochor_engine PRIVATE Eigen3::Eigen)

isochor_sources(_constraints constraints/stencil constraints/volume constraints/chamber constraints/layer
  constraints/line constraints/support constraints/load constraints/contact constraints/contact/friction
  constraints/contact/shape constraints/contact/rigid constraints/contact/surface)
isochor_module(constraints ${_constraints})
target_link_libraries(isochor_constraints PUBLIC isochor_engine PRIVATE Eigen3::Eigen)

isochor_sources(_integrators integrators)
isochor_module(integrators ${_integrators})
target_link_libraries(isochor_integrators PUBLIC isochor_engine)

add_library(isochor INTERFACE)
add_library(isochor::isochor ALIAS isochor)
target_link_libraries(isochor INTERFACE isochor_materials isochor_constraints isochor_integrators isochor_engine)
set_property(GLOBAL APPEND PROPERTY ISOCHOR_MODULES isochor)

get_property(_modules GLOBAL PROPERTY ISOCHOR_MODULES)
install(TARGETS ${_modules} EXPORT isochor-targets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(DIRECTORY include/isochor DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(EXPORT isochor-targets NAMESPACE isochor:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/isochor)
configure_package_config_file(cmake/isochor-config.cmake.in ${CMAKE_CURRENT_BINARY_DIR}/isochor-config.cmake
  INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/isochor)
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/isochor-config-version.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/isochor-config.cmake ${CMAKE_CURRENT_BINARY_DIR}/isochor-config-version.cmake
  cmake/FindMUMPS.cmake cmake/FindMETIS.cmake cmake/FindCHOLMOD.cmake
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/isochor)
