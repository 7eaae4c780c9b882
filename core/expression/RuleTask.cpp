// SPDX-License-Identifier: MIT
#include "core/expression/RuleTask.h"

#include "core/Error.h"
#include "core/Text.h"

namespace punctum::expression
{

std::string textOf(double v)
{
    return toText(Value(v));
}
std::string textOf(Int128 v)
{
    if (v >= std::numeric_limits<std::int64_t>::min() && v <= std::numeric_limits<std::int64_t>::max())
        return toText(Value(std::int64_t(v)));
    return v > 0 && v <= std::numeric_limits<std::uint64_t>::max() ? toText(Value(std::uint64_t(v)))
                                                                   : toText(Value(double(v)));
}

namespace
{

/// What an attribute can hold: "holds 0 to 31".
std::string holdsText(const Attribute& a)
{
    if (a.bitWidth != 0) return "holds 0 to " + std::to_string(a.maxBits());
    return visitScalar(a.type(), [&](auto zero) {
        using T = decltype(zero);
        using Limits = std::numeric_limits<T>;
        double lo = double(Limits::lowest()), hi = double(Limits::max());
        if (!a.scaled && std::is_integral_v<T>)
            return "holds " + textOf(Int128(Limits::lowest())) + " to " + textOf(Int128(Limits::max()));
        if (a.scaled) {
            lo = lo * a.scale + a.offset;
            hi = hi * a.scale + a.offset;
        }
        return "holds " + textOf(std::min(lo, hi)) + " to " + textOf(std::max(lo, hi));
    });
}

}  // namespace

bool isClassByte(const Attribute& a)
{
    return a.kind == AttributeKind::Class && a.type() == ScalarType::U8 && a.bitShift == 0;
}

Attribute widest(Attribute target)
{
    if (isClassByte(target)) target.bitWidth = 0;
    return target;
}

void refuse(const Misfit& misfit, const Attribute& target)
{
    if (misfit.value.empty()) return;
    throw Error(target.name + " " + holdsText(widest(target)) + "; the value " + misfit.value + " of point " +
                grouped(misfit.point) + " does not fit.");
}

}  // namespace punctum::expression
