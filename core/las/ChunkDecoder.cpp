// SPDX-License-Identifier: MIT
#include "core/las/ChunkDecoder.h"

#include "core/las/LayeredDecoder.h"
#include "core/las/PointwiseDecoder.h"

namespace punctum::las
{

std::unique_ptr<ChunkDecoder> ChunkDecoder::make(const LazInfo& info)
{
    if (LayeredDecoder::supports(info)) return std::make_unique<LayeredDecoder>(info);
    if (PointwiseDecoder::supports(info)) return std::make_unique<PointwiseDecoder>(info);
    return nullptr;
}

}  // namespace punctum::las
