// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/PointFigures.h"
#include "core/las/SourceFile.h"

#include <string>
#include <vector>

namespace punctum::las
{

/// Something that is wrong with a file, for people: docs/dev/las.md has the table of them.
struct Finding {
    std::string fault;        ///< a sentence, with the figures
    std::string mend;         ///< a sentence: what would mend it, or that nothing can
    bool repairable = false;  ///< the header alone is wrong, and the data say what is right: repair() mends it
};

/// What the doctor finds.
struct Diagnosis {
    std::vector<Finding> findings;
    Header mended;  ///< the file's header with all that is repairable put right

    bool repairable() const;
};

/// Holds header and records against each other and against the points. `figures`: of all points of the file as they
/// were read, those that could not be read left out. Any thread; looks at no file.
Diagnosis diagnose(const SourceFile& source, const PointFigures& figures);

/// The file as it was read: its points' figures, and what is wrong with it. The cloud's values must still be those
/// of its file. Throws Cancelled.
struct Examination {
    PointFigures figures;
    Diagnosis diagnosis;
};
Examination examine(const PointCloud& cloud, Progress& progress);

}  // namespace punctum::las
