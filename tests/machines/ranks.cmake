# Scenes on 1 to 4 ranks against the engine alone. Ranks need not have a core each, and may be root's in a container.
set(_ranks_environment OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMP_NUM_THREADS=1
    "OMPI_MCA_rmaps_base_oversubscribe=1" "OMPI_MCA_hwloc_base_binding_policy=none" OMPI_MCA_mpi_yield_when_idle=1)
target_compile_definitions(isochor_machines_tests PRIVATE ISOCHOR_MPIRUN="${MPIEXEC_EXECUTABLE}")
get_property(_entries DIRECTORY PROPERTY TESTS)
list(FILTER _entries INCLUDE REGEX "^machines\\.")
foreach(entry ${_entries})
  set_tests_properties(${entry} PROPERTIES ENVIRONMENT "${_ranks_environment}" RUN_SERIAL ON)
endforeach()

add_executable(isochor_compare_ranks machines/compare/compare.cpp)
target_include_directories(isochor_compare_ranks PRIVATE ${PROJECT_SOURCE_DIR})
target_link_libraries(isochor_compare_ranks PRIVATE isochor_options isochor::scenes isochor::petsc)

set(_own ${CMAKE_CURRENT_SOURCE_DIR}/machines/scenes)
set(_statics "cantilever_tenth" "torsion" "thick_tube@steps 2" "cable_finger" "puck_skin@steps 6")
set(_chambers "gas_tube@steps 4" "thick_sphere_volume@steps 2" "two_chambers@steps 4" "tube@steps 2")
set(_contact "incline@steps 12" "squeezed_block@steps 10" "ball_drop@bodies[0].mesh.file=meshes/ball_small.msh@steps 24"
    "indented_puck@steps 1" "${_own}/rubbed_block.json"
    "${_own}/rubbed_block.json@contacts[0].coupling=coupled" "${_own}/stacked_blocks.json"
    "${_own}/stacked_blocks.json@surface_contacts[0].coupling=coupled" "bellows@steps 3")
set(_elements "${_own}/tied_blocks.json" "${_own}/tied_blocks.json@bodies[0].element=tet10@bodies[1].element=tet10"
    "${_own}/tied_blocks.json@bodies[0].element=tet4_edge_smoothed"
    "${_own}/tied_blocks.json@bodies[0].element=hex8@bodies[0].mesh.box.cell_type=hex8"
    "${_own}/wide_rows.json" "${_own}/thrown_block.json" "${_own}/condensed_rows.json" "${_own}/bent_path.json")
# A sample of what library_table.py compares in full.
set(_library "colliding_balls@steps 20" "elbow@steps 2" "painted_arm@steps 1" "thin_strip@steps 1")
foreach(ranks 1 2 3 4)
  foreach(group statics chambers contact elements library)
    add_test(NAME machines.${group}_on_${ranks} COMMAND ${MPIEXEC_EXECUTABLE} ${MPIEXEC_NUMPROC_FLAG} ${ranks}
             $<TARGET_FILE:isochor_compare_ranks> ${_${group}})
    set_tests_properties(machines.${group}_on_${ranks} PROPERTIES ENVIRONMENT "${_ranks_environment}" RUN_SERIAL ON
                         TIMEOUT 600)
  endforeach()
endforeach()
