# What libisochor.so shows: its own names, among them those that hosts call, and nothing of the libraries inside.
# In: NM, LIBRARY
cmake_minimum_required(VERSION 3.25)
execute_process(COMMAND ${NM} -D -C --defined-only ${LIBRARY} OUTPUT_VARIABLE symbols COMMAND_ERROR_IS_FATAL ANY)
foreach(name "isochor::World::create(" "isochor::volume(" "isochor::read_mesh(" "isochor::Builder::add_rows(")
  string(FIND "${symbols}" "${name}" at)
  if(at EQUAL -1)
    message(SEND_ERROR "${LIBRARY} does not show ${name}")
  endif()
endforeach()
foreach(name "Eigen::" "pugi::" "isochor::Kkt" "isochor::Newton" "isochor::MultifrontalSolver"
             "isochor::EnclosedVolumePool" "isochor::mesh_files::")
  string(REGEX MATCH "[0-9a-f]+ [TBDR] [^\n]*${name}[^\n]*" shown "${symbols}")
  if(shown)
    message(SEND_ERROR "${LIBRARY} shows ${shown}")
  endif()
endforeach()
