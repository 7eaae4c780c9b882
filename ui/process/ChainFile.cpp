// SPDX-License-Identifier: MIT
#include "ui/process/ChainFile.h"

#include "core/Error.h"
#include "core/expression/Condition.h"
#include "core/steps/Steps.h"
#include "ui/basic/Text.h"

#include <QJsonArray>
#include <QJsonDocument>
#include <QJsonObject>

namespace punctum::ui
{

namespace
{

const QString kSteps = QStringLiteral("steps"), kStep = QStringLiteral("step"), kValues = QStringLiteral("values"),
              kWithin = QStringLiteral("within");

/// Numbers and truth values may be written as such.
std::string plainText(const QJsonValue& value)
{
    if (value.isDouble()) return plainNumber(value.toDouble()).toStdString();
    return value.toVariant().toString().toStdString();
}

}  // namespace

QByteArray toRecipe(const std::vector<StepWish>& chain)
{
    QJsonArray steps;
    for (const StepWish& wish : chain) {
        QJsonObject values;
        for (const auto& [key, text] : wish.values) values[toQString(key)] = toQString(text);
        QJsonObject step{{kStep, toQString(wish.step)}, {kValues, values}};
        if (const std::string within = conditionOf(wish.scope); !within.empty()) step[kWithin] = toQString(within);
        steps.append(step);
    }
    return QJsonDocument(QJsonObject{{kSteps, steps}}).toJson();
}

std::vector<StepWish> fromRecipe(const QByteArray& json)
{
    QJsonParseError problem;
    const QJsonDocument document = QJsonDocument::fromJson(json, &problem);
    if (document.isNull())
        throw Error("This is no recipe: " + problem.errorString().toStdString() + " (byte " +
                    std::to_string(problem.offset) + ").");
    if (!document.object()[kSteps].isArray()) throw Error("This is no recipe: it has no list \"steps\".");
    std::vector<StepWish> chain;
    for (const auto& entry : document.object()[kSteps].toArray()) {
        const QJsonObject object = entry.toObject();
        StepWish wish;
        wish.step = object[kStep].toString().toStdString();
        const Step* const step = findStep(wish.step);
        if (step == nullptr) throw Error("There is no step \"" + wish.step + "\".");
        const QJsonObject values = object[kValues].toObject();
        for (auto it = values.begin(); it != values.end(); ++it)
            wish.values.emplace(it.key().toStdString(), plainText(it.value()));
        wish.scope.condition = object[kWithin].toString().toStdString();
        if (!wish.scope.condition.empty()) {
            checkNarrows(*step);
            expression::Condition::check(wish.scope.condition);
            wish.scope.kind = StepScope::Kind::Condition;
        }
        completeValues(*step, wish.values, !wish.scope.condition.empty());
        chain.push_back(std::move(wish));
    }
    return chain;
}

}  // namespace punctum::ui
