// SPDX-License-Identifier: MIT
#pragma once

#include "core/neighbors/KdOrder.h"
#include "core/shape/NormalColumns.h"

namespace punctum
{

class Progress;

/// Turns normals so that those of neighbors agree: Hoppe, DeRose, Duchamp, McDonald, Stuetzle, Surface
/// Reconstruction from Unorganized Points (1992), section 3.3: along a spanning tree of the graph of neighbors
/// whose edges weigh 1 less the cosine between the normals, so that it crosses edges of the surface last. Of each
/// part that hangs together the highest point's normal looks up.
///
/// `of`: the points whose normals are turned, and whose neighbors count; null: all. Edges are taken in bands of
/// weight, so that they need little memory. The same on any number of threads. Throws Cancelled.
void orientBySpanningTree(const KdOrder& order, NormalColumns& normals, std::size_t pointCount, const PointSet* of,
                          Progress& progress);

}  // namespace punctum
