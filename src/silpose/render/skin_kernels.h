// The loops of ProjectedSkin over vertices, by Highway: built for every instruction set and chosen at run time.
// Threads: pure functions.
#pragma once

#include <cstddef>
#include <cstdint>

#include "silpose/render/raster_grid.h"

namespace silpose {

// Vertices are handled in chunks of this many, numbers of theirs kept side by side.
inline constexpr size_t kChunkLanes = 16;
struct alignas(64) ChunkFloats {
  float lane[kChunkLanes];
};

// The joints that move any vertex of a chunk: entries [begin, end).
struct SkinChunk {
  uint32_t begin = 0, end = 0;
};
// One joint's part of a chunk: rest coordinates times weight, and the weight.
struct SkinEntry {
  ChunkFloats x, y, z, w;
};

struct ProjectionBounds {
  float x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  bool all_seen = false;  // nothing is nearer than PinholeCamera::kNear; else the rest means nothing
};

// A skin and the pose it takes.
struct SkinView {
  const SkinChunk* chunks;
  size_t num_chunks;
  const SkinEntry* entries;
  const uint32_t* entry_joint;  // [entries]
  const float* matrices;        // [J, 3, 4] row by row, to homogeneous pixels
};

// Pixels of all vertices, and their depth.
void skin_and_project(const SkinView& skin, ChunkFloats* x, ChunkFloats* y, ChunkFloats* depth);

// The same at once as points of a grid, as round_points(). False when a vertex is nearer than PinholeCamera::kNear:
// then the points mean nothing.
[[nodiscard]] bool skin_and_round(const SkinView& skin, const GridAxis& x_axis, const GridAxis& y_axis,
                                  GridPoint* points);

// The same at once as pixels, x and y alternating. False as above.
[[nodiscard]] bool skin_to_pixels(const SkinView& skin, float* xy);

// Points of the plane z = 1 to pixels through a lens: fx, fy, cx, cy, then OpenCV's k1 k2 p1 p2 k3.
struct LensFloats {
  float fx, fy, cx, cy;
  float k[5];
};
void distort_points(const LensFloats& lens, size_t num_chunks, ChunkFloats* x, ChunkFloats* y);

ProjectionBounds bounds_of_points(size_t num_chunks, const ChunkFloats* x, const ChunkFloats* y,
                                  const ChunkFloats* depth);

// As GridAxis::round, x and y alternating.
void round_points(const GridAxis& x_axis, const GridAxis& y_axis, size_t num_chunks, const ChunkFloats* x,
                  const ChunkFloats* y, GridPoint* points);

}  // namespace silpose
