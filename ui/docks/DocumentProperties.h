// SPDX-License-Identifier: MIT
#pragma once

#include <QString>

#include <vector>

namespace punctum
{
struct Inspection;
}

namespace punctum::ui
{

class Document;

/// What the properties dock tells of a file, in sections. GUI thread.
struct PropertySection {
    struct Row {
        QString name;  ///< empty: the value stands alone
        QString value;
        QString details = {};  ///< lines of a report that the value leads to; mostly none
    };
    QString title;
    std::vector<Row> rows;
};

/// `inspection`: null while not known.
std::vector<PropertySection> documentProperties(const Document& document, const Inspection* inspection);

}  // namespace punctum::ui
