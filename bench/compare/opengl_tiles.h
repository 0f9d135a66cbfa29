// OpenGlTiles: OpenGL on Mesa's software driver (llvmpipe), without a window: one context that draws poses side by side
// into one target and reads it back. Skinning is the vertex shader's, with a pose's matrices in a uniform buffer.
// Threads: one thread at a time; different objects may work in parallel.
#pragma once

#include <EGL/egl.h>
#include <GL/glcorearb.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "silhouette_scene.h"

namespace silpose::bench {

struct OpenGlSetup {
  const char* name;
  int num_contexts;          // as many threads shade vertices and set up triangles, each into its own target
  const char* fill_threads;  // of each context, that fill triangles; "0": the calling thread does
  int tiles_a_side;          // of the target
};

class OpenGlTiles {
 public:
  // Number 0 or 1; only one of each at a time, with a driver of its own. The scene must outlive it.
  // Errors: throws std::runtime_error where the driver does not start, or is not the software driver.
  OpenGlTiles(const SilhouetteScene& scene, const OpenGlSetup& setup, int number);
  OpenGlTiles(const OpenGlTiles&) = delete;
  OpenGlTiles& operator=(const OpenGlTiles&) = delete;
  ~OpenGlTiles();

  // Pixels of poses first, first + 1, ... that differ from `observed` (bytes of 0 or 1, the window's size). May be
  // called from any thread.
  void distances(size_t first, std::span<const uint8_t> observed, std::span<int64_t> out);

 private:
  void make_current(bool current);
  void make_mesh();
  void make_program();
  void make_target();
  void draw(size_t first, size_t count);

  const SilhouetteScene* scene_;
  int tiles_a_side_, num_bones_ = 0;  // of a vertex, at most
  size_t num_joints_;
  EGLDisplay display_ = EGL_NO_DISPLAY;
  EGLContext context_ = EGL_NO_CONTEXT;
  GLsizei num_indices_ = 0;
  size_t palette_stride_ = 0;          // bytes per pose
  std::vector<std::byte> palettes_;    // [tiles, palette_stride_]
  std::vector<ClipFromRest> palette_;  // [J]
  std::vector<uint8_t> pixels_;        // of the target
};

}  // namespace silpose::bench
