# SPDX-License-Identifier: MIT
# Installs the library into a folder of its own, builds docs/dev/example with nothing else, and looks at what it does.
set(scratch ${BUILD}/tests/example)
file(REMOVE_RECURSE ${scratch})
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE code OUTPUT_VARIABLE output ERROR_VARIABLE output)
  set(output "${output}" PARENT_SCOPE)
  if(NOT code EQUAL 0)
    message(FATAL_ERROR "${ARGN}: ${code}\n${output}")
  endif()
endfunction()

run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${scratch}/installed --component devel)
run(${CMAKE_COMMAND} -S ${SOURCE}/docs/dev/example -B ${scratch}/build -G Ninja -DCMAKE_BUILD_TYPE=Release
  -DCMAKE_CXX_COMPILER=${COMPILER} -DCMAKE_PREFIX_PATH=${scratch}/installed)
run(${CMAKE_COMMAND} --build ${scratch}/build)
run(${MAKE_SAMPLE} --sample ${scratch}/a.laz)
run(${scratch}/build/classify ${scratch}/a.laz ${scratch}/b.laz "Classification = 7 if Intensity > 0")
if(NOT output MATCHES "^[1-9][0-9]* points changed; Classification")
  message(FATAL_ERROR "It said: ${output}")
endif()
execute_process(COMMAND ${scratch}/build/classify ${scratch}/a.laz ${scratch}/c.laz "Classification = "
  RESULT_VARIABLE code ERROR_VARIABLE output)
if(NOT code EQUAL 1 OR NOT output MATCHES "^Column [0-9]+: .*\\.\n$" OR EXISTS ${scratch}/c.laz)
  message(FATAL_ERROR "A rule that is none gave ${code}: ${output}")
endif()
file(REMOVE_RECURSE ${scratch})
