// SPDX-License-Identifier: MIT
// An expression, read as a condition and as a rule, on a fixed cloud: a result or one sentence. A condition holds
// of each point or not, however the cloud is cut into pieces; a rule does to the points within what its preview
// shows, sets nothing but its target, and has nothing left to do once it has been followed.
//
// The first byte of the input: 1 the odd cloud (else the sample); 2 a rule changes some points alone; 4 a rule adds
// its attribute, of the type that the byte's upper half tells.
#include "core/expression/Condition.h"
#include "core/expression/ExpressionError.h"
#include "core/expression/Rule.h"
#include "core/task/Progress.h"
#include "tests/fuzz/FixedCloud.h"
#include "tests/fuzz/Fuzz.h"

#include <cstring>

using namespace punctum;
using fuzz::promise;

namespace
{

template <typename Work>
void orSentence(Work work)
{
    try {
        work();
    } catch (const Error& e) {
        fuzz::checkSentence(e);
    }
}

void checkCondition(const std::string& text, const PointCloud& cloud)
{
    Progress progress;
    const expression::Condition condition(text, cloud);
    const auto points = expression::select(cloud, condition, progress);
    for (std::size_t w = 0; w < points->words().size(); ++w) {
        std::uint64_t word = 0;
        condition.evaluate(w, w + 1, &word);
        promise(word == points->words()[w], "a piece of the cloud gives the same");
    }
    auto others = *expression::selectOthers(cloud, condition, progress);
    others.invert();
    promise(others == *points, "of each point it holds or not");
    for (const std::string& name : condition.attributes())
        promise(cloud.findAttribute(name) != nullptr, "it reads what there is");
}

void checkRule(const expression::Rule& rule, const fuzz::Fixed& fixed, const PointSet* within)
{
    Progress progress;
    const auto cloud = fuzz::copyOf(*fixed.cloud);
    const auto before = snapshot(*cloud);
    const auto preview = rule.preview(*cloud, within, progress);
    promise(snapshot(*cloud) == before, "a preview changes nothing");
    const auto command = rule.run(*cloud, within, progress);
    promise(snapshot(*cloud) == before, "a command that is not done changes nothing");
    promise((preview == nullptr) == (command == nullptr), "preview and command agree on whether there is a change");
    if (!command) return;
    promise(command->changedPoints() == preview->points->count(), "they agree on how many points it is");
    command->apply(*cloud);
    const Attribute target = *cloud->findAttribute(rule.target());
    const Attribute& shown = preview->attributes[0];
    for (PointIndex i = 0; i < fuzz::kPoints; ++i) {
        // one NaN is as good as another
        const double a = target.number(i), b = shown.number(i);
        promise(toText(target.value(i)) == toText(shown.value(i)) || (a != a && b != b),
                "the preview shows what comes");
        if (within == nullptr || within->contains(i)) continue;
        promise(!preview->points->contains(i), "points outside stay as they are");
    }
    command->apply(*cloud);
    promise(snapshot(*cloud) == before, "undone, all is as it was");
}

void checkNew(const expression::Rule& rule, const fuzz::Fixed& fixed, ScalarType type)
{
    Progress progress;
    const auto cloud = fuzz::copyOf(*fixed.cloud);
    const auto before = snapshot(*cloud);
    const auto command = rule.add(*cloud, type, nullptr, progress);
    command->apply(*cloud);
    const Attribute* const added = cloud->findAttribute(rule.target());
    promise(added != nullptr && added->type() == type, "the attribute is there");
    command->apply(*cloud);
    promise(snapshot(*cloud) == before, "undone, all is as it was");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    fuzz::oneThread();
    fuzz::Input input(data, size);
    const auto flags = input.take<std::uint8_t>();
    const std::string text(reinterpret_cast<const char*>(input.rest().data()), input.rest().size());
    const fuzz::Fixed& fixed = fuzz::fixedCloud((flags & 1) != 0);
    orSentence([&] { checkCondition(text, *fixed.cloud); });
    orSentence([&] {
        const expression::Rule rule(text);
        if ((flags & 4) != 0) return checkNew(rule, fixed, ScalarType((flags >> 4) % (int(ScalarType::F64) + 1)));
        PointSet some(fuzz::kPoints);
        for (PointIndex i = 0; i < fuzz::kPoints; i += 3) some.insert(i);
        checkRule(rule, fixed, (flags & 2) != 0 ? &some : nullptr);
    });
    return 0;
}
