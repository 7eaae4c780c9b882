# SPDX-License-Identifier: MIT
# Run by punctum_embed at build time: writes resources.h and resources.cpp, and uniforms.h from the table of uniforms.
file(WRITE ${OUT}/resources.h "// Generated from resources/. Do not edit.
#pragma once
#include <string_view>
namespace punctum {
/// Contents of an embedded file; empty when there is none of that name.
std::string_view resource(std::string_view name);
}
")
set(table "")
foreach(file IN LISTS FILES)
  file(READ ${ROOT}/${file} text)
  string(APPEND table "    {\"${file}\", R\"~~~(${text})~~~\"},\n")
endforeach()
file(WRITE ${OUT}/resources.cpp "// Generated from resources/. Do not edit.
#include \"resources.h\"
#include <utility>
namespace punctum {
namespace {
constexpr std::pair<std::string_view, std::string_view> kFiles[] = {
${table}};
}
std::string_view resource(std::string_view name)
{
    for (const auto& [path, text] : kFiles)
        if (path == name) return text;
    return {};
}
}
")

file(STRINGS ${ROOT}/shaders/uniforms.txt lines REGEX "^[A-Za-z]")
set(location 0)
set(constants "")
set(defines "")
foreach(line IN LISTS lines)
  if(NOT line MATCHES "^([a-z][A-Za-z0-9]*)( ([0-9]+))?$")
    message(FATAL_ERROR "shaders/uniforms.txt: \"${line}\" is not a name and a number of elements")
  endif()
  set(name ${CMAKE_MATCH_1})
  set(elements 1)
  if(CMAKE_MATCH_3)
    set(elements ${CMAKE_MATCH_3})
  endif()
  string(SUBSTRING ${name} 0 1 initial)
  string(SUBSTRING ${name} 1 -1 rest)
  string(TOUPPER ${initial} initial)
  string(APPEND constants "inline constexpr int k${initial}${rest} = ${location};\n")
  string(APPEND defines "#define AT_${name} ${location}\\n")
  math(EXPR location "${location} + ${elements}")
endforeach()
file(WRITE ${OUT}/uniforms.h "// Generated from resources/shaders/uniforms.txt. Do not edit.
#pragma once
#include <string_view>
/// Locations of uniforms.
namespace punctum::render::at {
${constants}}
namespace punctum::render {
/// How every shader begins: the version, and the same locations as AT_name.
inline constexpr std::string_view kShaderHead = \"#version 430 core\\n${defines}\";
}
")
