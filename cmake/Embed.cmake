# SPDX-License-Identifier: MIT
# punctum_embed(TARGET FILE...): compiles files of resources/ into TARGET. The target's code finds them with
# punctum::resource("shaders/points.vert.glsl"), declared in the generated header "resources.h". Beside it
# "uniforms.h" has the locations of the shaders' uniforms (resources/shaders/uniforms.txt).

function(punctum_embed target)
  set(out ${CMAKE_CURRENT_BINARY_DIR}/embedded)
  set(files ${ARGN})
  list(TRANSFORM files PREPEND ${PROJECT_SOURCE_DIR}/resources/ OUTPUT_VARIABLE paths)
  add_custom_command(
    OUTPUT ${out}/resources.cpp ${out}/resources.h ${out}/uniforms.h
    COMMAND ${CMAKE_COMMAND} -DOUT=${out} "-DFILES=${files}" -DROOT=${PROJECT_SOURCE_DIR}/resources
            -P ${PROJECT_SOURCE_DIR}/cmake/EmbedScript.cmake
    DEPENDS ${paths} ${PROJECT_SOURCE_DIR}/resources/shaders/uniforms.txt
            ${PROJECT_SOURCE_DIR}/cmake/EmbedScript.cmake
    VERBATIM)
  target_sources(${target} PRIVATE ${out}/resources.cpp ${out}/resources.h ${out}/uniforms.h)
  target_include_directories(${target} PRIVATE ${out})
endfunction()
