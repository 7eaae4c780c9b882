// SPDX-License-Identifier: MIT
#include "ui/document/Distinctions.h"

#include <QHash>

#include <algorithm>
#include <vector>

namespace punctum::ui
{

QStringList distinctionsOf(const QStringList& paths)
{
    std::vector<QStringList> folders;
    qsizetype deepest = 0;
    for (const QString& path : paths) {
        folders.push_back(path.split(QLatin1Char('/')));
        folders.back().removeLast();
        deepest = std::max(deepest, folders.back().size());
    }
    const auto end = [&](std::size_t k, qsizetype parts) {
        return folders[k].mid(std::max<qsizetype>(0, folders[k].size() - parts)).join(QLatin1Char('/'));
    };
    QStringList ends(paths.size());
    for (qsizetype parts = 1; parts <= deepest; ++parts) {
        QHash<QString, int> uses;
        for (std::size_t k = 0; k < folders.size(); ++k) ++uses[end(k, parts)];
        for (std::size_t k = 0; k < folders.size(); ++k)
            if (QString& own = ends[qsizetype(k)]; own.isEmpty() && (uses[end(k, parts)] == 1 || parts == deepest))
                own = end(k, parts);
    }
    return ends;
}

}  // namespace punctum::ui
