// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <utility>

namespace punctum
{

/// The types a column can hold: those of LAS records and extra bytes (LAS 1.4 R15, table 24).
enum class ScalarType : std::uint8_t { U8, I8, U16, I16, U32, I32, U64, I64, F32, F64 };

constexpr std::size_t sizeOf(ScalarType type) noexcept
{
    switch (type) {
        case ScalarType::U8:
        case ScalarType::I8:
            return 1;
        case ScalarType::U16:
        case ScalarType::I16:
            return 2;
        case ScalarType::U32:
        case ScalarType::I32:
        case ScalarType::F32:
            return 4;
        case ScalarType::U64:
        case ScalarType::I64:
        case ScalarType::F64:
            return 8;
    }
    return 0;
}

/// The name shown to users and written in JSON: "uint8", "int32", "float64", ...
constexpr std::string_view nameOf(ScalarType type) noexcept
{
    constexpr std::string_view kNames[] = {"uint8", "int8",   "uint16", "int16",   "uint32",
                                           "int32", "uint64", "int64",  "float32", "float64"};
    return kNames[std::size_t(type)];
}

constexpr bool isFloating(ScalarType type) noexcept
{
    return type == ScalarType::F32 || type == ScalarType::F64;
}

/// Calls `f` with a value of the C++ type that `type` stands for, so that a loop over a column is compiled
/// once per type: `visitScalar(type, [&](auto zero) { using T = decltype(zero); ... });`
template <typename F>
decltype(auto) visitScalar(ScalarType type, F&& f)
{
    switch (type) {
        case ScalarType::U8:
            return std::forward<F>(f)(std::uint8_t{});
        case ScalarType::I8:
            return std::forward<F>(f)(std::int8_t{});
        case ScalarType::U16:
            return std::forward<F>(f)(std::uint16_t{});
        case ScalarType::I16:
            return std::forward<F>(f)(std::int16_t{});
        case ScalarType::U32:
            return std::forward<F>(f)(std::uint32_t{});
        case ScalarType::I32:
            return std::forward<F>(f)(std::int32_t{});
        case ScalarType::U64:
            return std::forward<F>(f)(std::uint64_t{});
        case ScalarType::I64:
            return std::forward<F>(f)(std::int64_t{});
        case ScalarType::F32:
            return std::forward<F>(f)(float{});
        case ScalarType::F64:
            break;
    }
    return std::forward<F>(f)(double{});
}

}  // namespace punctum
