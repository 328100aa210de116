# Runs at build time (cmake -P): bundles the pages and writes them as a C++ source. A machine where npm cannot
# install still gets a library; it says that the page is missing.
# In: SOURCE_DIR, WORK_DIR, OUTPUT, NPM, NODE

# Reads as hex: text reading would trip over brackets and semicolons. Chunks stay below the length of literal
# that every compiler must accept.
function(chunks_of file out)
  file(READ "${file}" bytes HEX)
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "\\\\x\\1" bytes "${bytes}")
  set(chunks "")
  set(at 0)
  set(step 16000)  # a multiple of the four characters of one escaped byte
  string(LENGTH "${bytes}" length)
  while(at LESS length)
    string(SUBSTRING "${bytes}" ${at} ${step} chunk)
    string(APPEND chunks "    out += \"${chunk}\";\n")
    math(EXPR at "${at} + ${step}")
  endwhile()
  set(${out} "${chunks}" PARENT_SCOPE)
endfunction()

function(write_template_source results charts live)
  set(text "#include \"results_template.h\"\n\nnamespace isochor::page {\n\n")
  foreach(page results charts live)
    string(APPEND text "const std::string& ${page}_template() {\n  static const std::string html = []() {\n    std::string out;\n\
${${page}}    return out;\n  }();\n  return html;\n}\n\n")
  endforeach()
  file(WRITE "${OUTPUT}.new" "${text}}  // namespace isochor::page\n")
  file(RENAME "${OUTPUT}.new" "${OUTPUT}")
endfunction()

set(problem "node or npm was not found")
if(NPM AND NODE)
  set(problem "")
  file(COPY "${SOURCE_DIR}/package.json" "${SOURCE_DIR}/package-lock.json" "${SOURCE_DIR}/build.mjs"
       "${SOURCE_DIR}/src" DESTINATION "${WORK_DIR}")
  # node_modules is kept until the lock file changes.
  file(SHA256 "${SOURCE_DIR}/package-lock.json" lock)
  set(stamp "${WORK_DIR}/node_modules/.isochor-${lock}")
  if(NOT EXISTS "${stamp}")
    execute_process(COMMAND "${NPM}" ci --ignore-scripts --no-audit --no-fund --loglevel=error
                    WORKING_DIRECTORY "${WORK_DIR}" RESULT_VARIABLE status OUTPUT_VARIABLE log ERROR_VARIABLE log)
    if(status EQUAL 0)
      file(WRITE "${stamp}" "")
    else()
      set(problem "npm ci failed:\n${log}")
    endif()
  endif()
  if(NOT problem)
    execute_process(COMMAND "${NODE}" build.mjs "${WORK_DIR}/template.html" "${WORK_DIR}/charts.html" "${WORK_DIR}/live.html"
                    WORKING_DIRECTORY "${WORK_DIR}" RESULT_VARIABLE status OUTPUT_VARIABLE log ERROR_VARIABLE log)
    if(NOT status EQUAL 0)
      message(FATAL_ERROR "The results page does not bundle:\n${log}")
    endif()
  endif()
endif()

if(problem)
  message(WARNING "The results page is left out of this build: ${problem}")
  write_template_source("" "" "")
  file(WRITE "${WORK_DIR}/missing.txt" "${problem}\n")  # makes the next configure try again
  return()
endif()
file(REMOVE "${WORK_DIR}/missing.txt")

chunks_of("${WORK_DIR}/template.html" results)
chunks_of("${WORK_DIR}/charts.html" charts)
chunks_of("${WORK_DIR}/live.html" live)
write_template_source("${results}" "${charts}" "${live}")
