# One static library a module; isochor::isochor is all that a host needs, isochor::core the same without mesh files.
# Effects are object files in an archive, so a host links only those it names. With BUILD_SHARED_LIBS a host gets
# one libisochor.so made of the same object files; our own programs and tests, which see the inside, link the modules.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

add_library(isochor_options INTERFACE)
target_compile_features(isochor_options INTERFACE cxx_std_20)
target_compile_options(isochor_options INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion
  $<$<BOOL:${ISOCHOR_WERROR}>:-Werror>
  # g++ 12 reports its own AVX intrinsics as uninitialized.
  $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>
  # Where addresses have 32 bits, vectors are indexed by less than the counts of entries are kept in; what memory holds
  # fits both.
  $<$<AND:$<CXX_COMPILER_ID:Clang>,$<EQUAL:${CMAKE_SIZEOF_VOID_P},4>>:-Wno-shorten-64-to-32>
  # Clang 14 takes a member that a generic lambda calls for no use of `this`.
  $<$<CXX_COMPILER_ID:Clang>:-Wno-unused-lambda-capture>
  # Sums are written in the order that must hold; contraction to fused multiply-add is the compiler's choice per
  # build, not per thread count.
  $<$<BOOL:${ISOCHOR_NATIVE}>:-march=native>)

# Code around the engine, which runs once a scene: the time that compilers spend on optimizing it is not earned back.
# Not for files that use Eigen's dense algebra: their templates would take the place of the engine's when linked.
function(isochor_compile_quickly target)
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
endfunction()

# What the public headers say, as a number (isochor/abi.h). Builds of the same sources may share the folder of it, so that
# a compiler cache sees the same commands.
set(ISOCHOR_GENERATED_INCLUDE ${PROJECT_BINARY_DIR}/include CACHE PATH "Folder of isochor/abi.h")
mark_as_advanced(ISOCHOR_GENERATED_INCLUDE)
file(GLOB_RECURSE _public_headers CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/include/isochor/*.h)
add_custom_command(OUTPUT ${PROJECT_BINARY_DIR}/abi.stamp
  BYPRODUCTS ${ISOCHOR_GENERATED_INCLUDE}/isochor/abi.h
  COMMAND ${CMAKE_COMMAND} -DINCLUDE=${PROJECT_SOURCE_DIR}/include
    -DOUTPUT=${ISOCHOR_GENERATED_INCLUDE}/isochor/abi.h -P ${PROJECT_SOURCE_DIR}/cmake/Abi.cmake
  COMMAND ${CMAKE_COMMAND} -E touch ${PROJECT_BINARY_DIR}/abi.stamp
  DEPENDS ${_public_headers} ${PROJECT_SOURCE_DIR}/cmake/Abi.cmake
  COMMENT "Numbering the public headers" VERBATIM)
add_custom_target(isochor_abi DEPENDS ${PROJECT_BINARY_DIR}/abi.stamp)

set(_public_include $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include> $<BUILD_INTERFACE:${ISOCHOR_GENERATED_INCLUDE}>
    $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)

# isochor_module(name sources...): a static library with the include layout of the tree.
function(isochor_module name)
  add_library(isochor_${name} STATIC ${ARGN})
  add_library(isochor::${name} ALIAS isochor_${name})
  add_dependencies(isochor_${name} isochor_abi)
  target_include_directories(isochor_${name} PUBLIC ${_public_include} PRIVATE ${PROJECT_SOURCE_DIR})
  target_compile_features(isochor_${name} PUBLIC cxx_std_20)
  target_link_libraries(isochor_${name} PRIVATE $<BUILD_INTERFACE:isochor_options>)
  set_target_properties(isochor_${name} PROPERTIES EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON
    CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
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
if(ISOCHOR_WITH_TBB)
  target_link_libraries(isochor_base PRIVATE TBB::tbb)
else()
  target_compile_definitions(isochor_base PRIVATE ISOCHOR_WITHOUT_TBB)
endif()

isochor_sources(_mesh engine/mesh engine/mesh/check engine/mesh/make)
isochor_module(mesh ${_mesh})
target_link_libraries(isochor_mesh PUBLIC isochor_base)

isochor_sources(_mesh_files engine/mesh/read engine/mesh/write)
set(_vtu_libraries pugixml::pugixml ZLIB::ZLIB)
if(ISOCHOR_WITH_VTU)
  list(FILTER _mesh_files EXCLUDE REGEX "/without_vtu\\.cpp$")
else()
  list(FILTER _mesh_files EXCLUDE REGEX "/(read|write)_vtu\\.cpp$")
  set(_vtu_libraries)
endif()
isochor_module(mesh_files ${_mesh_files})
target_link_libraries(isochor_mesh_files PUBLIC isochor_mesh PRIVATE ${_vtu_libraries})

isochor_sources(_solvers engine/solvers engine/solvers/front engine/solvers/iterative engine/solvers/two_level engine/solvers/foreign)
isochor_module(solvers ${_solvers})
target_link_libraries(isochor_solvers PUBLIC isochor_base PRIVATE $<BUILD_INTERFACE:Eigen3::Eigen> Threads::Threads ${CMAKE_DL_LIBS})
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
target_link_libraries(isochor_engine PUBLIC isochor_mesh isochor_solvers PRIVATE $<BUILD_INTERFACE:Eigen3::Eigen>)

isochor_sources(_materials materials)
isochor_module(materials ${_materials})
target_link_libraries(isochor_materials PUBLIC isochor_engine PRIVATE $<BUILD_INTERFACE:Eigen3::Eigen>)

isochor_sources(_constraints constraints/stencil constraints/active constraints/volume constraints/chamber constraints/layer
  constraints/line constraints/support constraints/load constraints/contact constraints/contact/friction
  constraints/contact/shape constraints/contact/rigid constraints/contact/surface)
isochor_module(constraints ${_constraints})
target_link_libraries(isochor_constraints PUBLIC isochor_engine PRIVATE $<BUILD_INTERFACE:Eigen3::Eigen>)

isochor_sources(_integrators integrators)
isochor_module(integrators ${_integrators})
target_link_libraries(isochor_integrators PUBLIC isochor_engine)

# All modules, for our own programs and tests.
add_library(isochor_modules INTERFACE)
target_link_libraries(isochor_modules INTERFACE isochor_materials isochor_constraints isochor_integrators isochor_engine
                                                isochor_mesh_files)

get_property(_modules GLOBAL PROPERTY ISOCHOR_MODULES)
set(ISOCHOR_SHARED OFF)
if(BUILD_SHARED_LIBS)
  set(ISOCHOR_SHARED ON)
  set(_objects)
  foreach(module ${_modules})
    list(APPEND _objects $<TARGET_OBJECTS:${module}>)
  endforeach()
  add_library(isochor SHARED ${_objects})
  set_target_properties(isochor PROPERTIES LINKER_LANGUAGE CXX VERSION ${PROJECT_VERSION}
    SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
  target_compile_features(isochor PUBLIC cxx_std_20)
  target_include_directories(isochor PUBLIC ${_public_include})
  set(_private Threads::Threads ${_vtu_libraries} ${CMAKE_DL_LIBS})
  if(ISOCHOR_WITH_TBB)
    list(APPEND _private TBB::tbb)
  endif()
  foreach(backend MUMPS CHOLMOD METIS)
    if(ISOCHOR_HAVE_${backend})
      list(APPEND _private ${backend}::${backend})
    endif()
  endforeach()
  target_link_libraries(isochor PRIVATE "$<BUILD_INTERFACE:${_private}>")
  add_library(isochor_core INTERFACE)
  target_link_libraries(isochor_core INTERFACE isochor)
  set(_core isochor isochor_core)
  set(_files)
else()
  add_library(isochor_core INTERFACE)
  target_link_libraries(isochor_core INTERFACE isochor_materials isochor_constraints isochor_integrators isochor_engine)
  add_library(isochor INTERFACE)
  target_link_libraries(isochor INTERFACE isochor_core isochor_mesh_files)
  set(_core ${_modules} isochor_core)
  list(REMOVE_ITEM _core isochor_mesh_files)
  set(_files isochor_mesh_files isochor)
endif()
set_target_properties(isochor_core PROPERTIES EXPORT_NAME core)

# For effects, materials and time schemes of one's own (docs/adding-a-constraint.md): the engine's extension headers,
# under the names that they have here. They hold arithmetic for batches, which wants the engine's instructions.
include(HeaderClosure)
isochor_header_closure(_extension_headers engine/scene/builder.h engine/system/pool_facets.h engine/elements/material_model.h
  engine/step/time_scheme.h materials/energy_batch.h)
add_library(isochor_extend INTERFACE)
target_link_libraries(isochor_extend INTERFACE isochor_core)
target_include_directories(isochor_extend INTERFACE $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
  $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/isochor/extend>)
target_compile_options(isochor_extend INTERFACE $<$<BOOL:${ISOCHOR_NATIVE}>:-march=native>)
set_target_properties(isochor_extend PROPERTIES EXPORT_NAME extend)
add_library(isochor::extend ALIAS isochor_extend)
list(APPEND _core isochor_extend)
add_library(isochor::isochor ALIAS isochor)
add_library(isochor::core ALIAS isochor_core)

set(_package ${CMAKE_INSTALL_LIBDIR}/cmake/isochor)
install(TARGETS ${_core} EXPORT isochor-core ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
        LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(EXPORT isochor-core NAMESPACE isochor:: DESTINATION ${_package})
if(_files)
  install(TARGETS ${_files} EXPORT isochor-files ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
  install(EXPORT isochor-files NAMESPACE isochor:: DESTINATION ${_package})
endif()
install(DIRECTORY include/isochor DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
foreach(header ${_extension_headers})
  get_filename_component(folder ${header} DIRECTORY)
  install(FILES ${header} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/isochor/extend/${folder})
endforeach()
install(FILES ${ISOCHOR_GENERATED_INCLUDE}/isochor/abi.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/isochor)
configure_package_config_file(cmake/isochor-config.cmake.in ${CMAKE_CURRENT_BINARY_DIR}/isochor-config.cmake
  INSTALL_DESTINATION ${_package})
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/isochor-config-version.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/isochor-config.cmake ${CMAKE_CURRENT_BINARY_DIR}/isochor-config-version.cmake
  cmake/FindMUMPS.cmake cmake/FindMETIS.cmake cmake/FindCHOLMOD.cmake DESTINATION ${_package})
