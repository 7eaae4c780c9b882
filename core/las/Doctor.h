// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/PointFigures.h"
#include "core/las/SourceFile.h"

#include <memory>
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

/// The file that holds the cloud at present (CurrentFile), that is the one it was read from or, later, the one it
/// was last saved to: its header and records, its points' figures, and what is wrong with it. The cloud's values
/// must be those of this file. Of a file that it was saved to the header and the records are read, no points.
/// Throws Error (that file cannot be read, or changed meanwhile) or Cancelled.
struct Examination {
    std::shared_ptr<const SourceFile> source;
    PointFigures figures;
    Diagnosis diagnosis;
};
Examination examine(const PointCloud& cloud, Progress& progress);

}  // namespace punctum::las
