// OutlineScan: the inside of a mesh's outline on a raster, as bits, by the non-zero winding rule.
// Every face turned towards the camera is wound the same way, so the winding number of a point is the number of faces
// above it, and only edges of the outline change it. Each is added where it crosses the middle of a column of pixels;
// summing down the columns, 64 side by side, then gives the winding numbers. At most 255 faces may lie above a pixel.
// By Highway, built for every instruction set and chosen at run time; the same for all of them.
// Threads: one thread per object.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "silpose/image/mask.h"
#include "silpose/render/outline_edges.h"
#include "silpose/render/raster_grid.h"
#include "silpose/render/silhouette.h"

namespace silpose {

class OutlineScan {
 public:
  explicit OutlineScan(const EdgeTopology& topology) : edges_(topology) {}  // keeps a reference

  // Scans the mesh whose vertices are projected to `points`, as OutlineEdges::find() takes it.
  void scan(std::span<const GridPoint> points, bool some_unseen, int width, int height,
            std::span<const Face> cut_faces = {});

  // Uses of the scanned silhouette: it is set in a cleared mask of the scan's size, counted against a mask, or its box
  // of pixels is found; nothing when it has none.
  void draw(Mask& mask) const;
  [[nodiscard]] OutlineRenderer::Counts count(const Mask& observed) const;
  [[nodiscard]] std::optional<PixelBounds> bounds() const;

  // The scanned silhouette itself: 64 pixels of a row per word, word columns of all rows one after the other. Words
  // outside of the rows and columns named mean nothing. Valid until the next scan.
  struct Bits {
    const uint64_t* words;  // [ceil(width / 64), height]
    int width, height;
    int row_begin, row_end, word_begin, word_end;
  };
  [[nodiscard]] Bits bits() const {
    return {inside_.get(), width_, height_, row_begin_, row_end_, word_begin_, word_end_};
  }

 private:
  void resize(int width, int height);

  OutlineEdges edges_;
  int width_ = 0, height_ = 0;
  // Where anything is inside, at most: rows, and words of 64 columns.
  int row_begin_ = 0, row_end_ = 0, word_begin_ = 0, word_end_ = 0;
  std::vector<int32_t> active_;  // [7, edges] scratch: edges that still have columns to cross
  // Large rasters take memory only where something was drawn: pages come zeroed from the system, when they are touched.
  struct Free {
    void operator()(void* memory) const { std::free(memory); }
  };
  std::unique_ptr<int8_t[], Free> changes_;  // [words, height + 1, 64] of the winding number; 0 between scans. Last
                                             // row: unread
  std::unique_ptr<uint64_t[]> inside_;       // [words, height] bits; valid within the rows and words above
};

}  // namespace silpose
