# SPDX-License-Identifier: MIT
# Run by punctum_embed at build time: writes resources.h and resources.cpp.
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
