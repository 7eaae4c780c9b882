// SPDX-License-Identifier: MIT
#pragma once

#include "core/process/Step.h"

namespace punctum
{

/// buildings height=2 area=10 class=6: classifies what has a roof: flat pieces above the ground, large and wide
/// enough together.
///
/// Points whose neighbors lie in a plane that is no wall are joined to pieces where planes agree (region growing by
/// smoothness: Rabbani, van den Heuvel and Vosselman 2006). Pieces of some size, seen from above, are roofs where
/// they make up an area that is large and wide enough. What is below and just above a roof is of the building, too.
/// Level pieces that come down to the ground are decks: bridges and ramps.
class BuildingsStep final : public Step
{
public:
    const StepDescription& description() const override;

private:
    std::unique_ptr<Command> make(const PointCloud& cloud, const StepValues& values, const PointSet* within,
                                  Progress& progress) const override;
};

}  // namespace punctum
