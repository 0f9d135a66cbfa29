#define GL_GLEXT_PROTOTYPES
#include "compare/opengl_tiles.h"

#include <EGL/eglext.h>
#include <fmt/format.h>
#include <meshoptimizer.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <string>
#include <string_view>

namespace silpose::bench {
namespace {

constexpr int kSet = 4;  // bones in one vertex attribute

void expect(bool condition, std::string_view what) {
  if (!condition) throw std::runtime_error(fmt::format("OpenGL: {}", what));
}

// Displays of different platforms do not share a driver's threads and locks.
EGLDisplay open_display(int number) {
  if (number == 0) return eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
  const auto query = reinterpret_cast<PFNEGLQUERYDEVICESEXTPROC>(eglGetProcAddress("eglQueryDevicesEXT"));
  std::array<EGLDeviceEXT, 16> devices{};
  EGLint num_devices = 0;
  expect(query != nullptr && query(devices.size(), devices.data(), &num_devices) == EGL_TRUE && num_devices > 0,
         "no EGL device");
  // The software device comes last.
  return eglGetPlatformDisplay(EGL_PLATFORM_DEVICE_EXT, devices[static_cast<size_t>(num_devices) - 1], nullptr);
}

GLuint compile(GLenum kind, const std::string& text) {
  const GLuint shader = glCreateShader(kind);
  const char* source = text.c_str();
  glShaderSource(shader, 1, &source, nullptr);
  glCompileShader(shader);
  GLint compiled = GL_FALSE;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
  expect(compiled == GL_TRUE, "a shader does not compile");
  return shader;
}

// A vertex in the buffer: its position, then sets of bones and their weights.
struct BoneSet {
  std::array<uint8_t, kSet> bone;
  std::array<float, kSet> weight;
};

size_t vertex_stride(int num_sets) { return sizeof(Eigen::Vector3f) + static_cast<size_t>(num_sets) * sizeof(BoneSet); }

// The vertices that are used, in their new order; ~0u: not used.
std::vector<std::byte> pack_vertices(const Mesh& mesh, const SkinWeights& skin, std::span<const uint32_t> new_from_old,
                                     size_t num_used, int num_sets) {
  const size_t stride = vertex_stride(num_sets);
  std::vector<std::byte> vertices(stride * num_used);
  for (size_t v = 0; v < new_from_old.size(); ++v) {
    if (new_from_old[v] == ~0u) continue;
    std::byte* const vertex = &vertices[stride * new_from_old[v]];
    std::memcpy(vertex, mesh.vertices[v].data(), sizeof(Eigen::Vector3f));
    std::vector<BoneSet> sets(static_cast<size_t>(num_sets), BoneSet{});
    for (uint32_t i = skin.row_start[v]; i < skin.row_start[v + 1]; ++i) {
      const size_t slot = i - skin.row_start[v];
      sets[slot / kSet].bone[slot % kSet] = static_cast<uint8_t>(skin.joint_idx[i]);
      sets[slot / kSet].weight[slot % kSet] = skin.weight[i];
    }
    std::memcpy(vertex + sizeof(Eigen::Vector3f), sets.data(), sets.size() * sizeof(BoneSet));
  }
  return vertices;
}

// Makes the current vertex array read the current buffer as pack_vertices() fills it.
void describe_vertices(int num_sets) {
  const auto at = [](size_t offset) { return reinterpret_cast<const void*>(offset); };
  const auto step = static_cast<GLsizei>(vertex_stride(num_sets));
  glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, step, nullptr);
  glEnableVertexAttribArray(0);
  for (int set = 0; set < num_sets; ++set) {
    const size_t offset = sizeof(Eigen::Vector3f) + static_cast<size_t>(set) * sizeof(BoneSet);
    const auto bones = static_cast<GLuint>(1 + 2 * set), weights = bones + 1;
    glVertexAttribIPointer(bones, kSet, GL_UNSIGNED_BYTE, step, at(offset));
    glVertexAttribPointer(weights, kSet, GL_FLOAT, GL_FALSE, step, at(offset + offsetof(BoneSet, weight)));
    glEnableVertexAttribArray(bones);
    glEnableVertexAttribArray(weights);
  }
}

}  // namespace

OpenGlTiles::OpenGlTiles(const SilhouetteScene& scene, const OpenGlSetup& setup, int number)
    : scene_(&scene),
      tiles_a_side_(setup.tiles_a_side),
      num_joints_(static_cast<size_t>(scene.body->skeleton.num_joints())),
      palette_(num_joints_) {
  setenv("LIBGL_ALWAYS_SOFTWARE", "1", 1);
  setenv("GALLIUM_DRIVER", "llvmpipe", 1);
  setenv("LP_NUM_THREADS", setup.fill_threads, 1);
  display_ = open_display(number);
  expect(display_ != EGL_NO_DISPLAY && eglInitialize(display_, nullptr, nullptr) == EGL_TRUE, "EGL does not start");
  eglBindAPI(EGL_OPENGL_API);
  constexpr std::array<EGLint, 7> kAttributes = {
      EGL_CONTEXT_MAJOR_VERSION,           4,       EGL_CONTEXT_MINOR_VERSION, 5, EGL_CONTEXT_OPENGL_PROFILE_MASK,
      EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
  context_ = eglCreateContext(display_, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, kAttributes.data());
  expect(context_ != EGL_NO_CONTEXT, "no context of version 4.5");
  make_current(true);
  const std::string_view driver = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
  expect(driver.starts_with("llvmpipe"), fmt::format("the driver is {}", driver));
  make_mesh();
  make_program();
  make_target();
  // The mesh is closed: faces turned away add nothing to its silhouette.
  glEnable(GL_CULL_FACE);
  glFrontFace(GL_CW);  // y runs down
  expect(glGetError() == GL_NO_ERROR, "set-up failed");
  make_current(false);
}

OpenGlTiles::~OpenGlTiles() {
  eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  eglDestroyContext(display_, context_);
  eglTerminate(display_);  // the next one's driver starts from scratch, with its own number of threads
}

void OpenGlTiles::make_current(bool current) {
  expect(eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, current ? context_ : EGL_NO_CONTEXT) == EGL_TRUE,
         "the context cannot be used");
}

// Triangles in the order of the vertex cache, vertices in the order of their first use.
void OpenGlTiles::make_mesh() {
  const Mesh& mesh = scene_->body->rest;
  const SkinWeights& skin = scene_->body->skin;
  const size_t num_vertices = mesh.vertices.size();
  expect(num_vertices < 1 << 16, "more vertices than 16-bit indices reach");
  std::vector<uint32_t> indices;
  for (const Face& face : mesh.faces) indices.insert(indices.end(), face.begin(), face.end());
  meshopt_optimizeVertexCache(indices.data(), indices.data(), indices.size(), num_vertices);
  std::vector<uint32_t> new_from_old(num_vertices);
  const size_t num_used =
      meshopt_optimizeVertexFetchRemap(new_from_old.data(), indices.data(), indices.size(), num_vertices);
  std::vector<uint16_t> short_indices;
  for (const uint32_t index : indices) short_indices.push_back(static_cast<uint16_t>(new_from_old[index]));
  num_indices_ = static_cast<GLsizei>(indices.size());

  for (size_t v = 0; v < num_vertices; ++v) {
    num_bones_ = std::max(num_bones_, static_cast<int>(skin.row_start[v + 1] - skin.row_start[v]));
  }
  const int num_sets = (num_bones_ + kSet - 1) / kSet;
  const std::vector<std::byte> vertices = pack_vertices(mesh, skin, new_from_old, num_used, num_sets);

  GLuint array = 0;
  std::array<GLuint, 2> buffers{};
  glGenVertexArrays(1, &array);
  glBindVertexArray(array);
  glGenBuffers(2, buffers.data());
  glBindBuffer(GL_ARRAY_BUFFER, buffers[0]);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(vertices.size()), vertices.data(), GL_STATIC_DRAW);
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, buffers[1]);
  glBufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(short_indices.size() * sizeof(uint16_t)),
               short_indices.data(), GL_STATIC_DRAW);
  describe_vertices(num_sets);
}

void OpenGlTiles::make_program() {
  std::string head = "#version 450 core\nlayout(location = 0) in vec3 rest;\n", sum;
  for (int bone = 0; bone < num_bones_; ++bone) {
    const int set = bone / kSet;
    const char component = "xyzw"[bone % kSet];
    if (bone % kSet == 0) {
      head += fmt::format("layout(location = {}) in uvec4 bone{};\nlayout(location = {}) in vec4 weight{};\n",
                          1 + 2 * set, set, 2 + 2 * set, set);
    }
    // Few vertices have more bones than one: where all of those that are shaded together have no more, the rest is
    // left out.
    if (bone > 0) sum += fmt::format("if (weight{}.{} > 0) ", set, component);
    sum += fmt::format("add(bone{0}.{1}, weight{0}.{1});\n", set, component);
  }
  const std::string vertex = head + fmt::format(R"(
layout(std140, binding = 0) uniform Palette {{ vec4 row[{}]; }};
vec4 x = vec4(0), y = vec4(0), w = vec4(0);
void add(uint joint, float weight) {{
  x += weight * row[3 * joint];
  y += weight * row[3 * joint + 1];
  w += weight * row[3 * joint + 2];
}}
void main() {{
  {}
  vec4 point = vec4(rest, 1);
  gl_Position = vec4(dot(x, point), dot(y, point), 0, dot(w, point));
}})",
                                                3 * num_joints_, sum);
  const GLuint program = glCreateProgram();
  glAttachShader(program, compile(GL_VERTEX_SHADER, vertex));
  glAttachShader(program,
                 compile(GL_FRAGMENT_SHADER, "#version 450 core\nout float inside;\nvoid main() { inside = 1; }\n"));
  glLinkProgram(program);
  GLint linked = GL_FALSE;
  glGetProgramiv(program, GL_LINK_STATUS, &linked);
  expect(linked == GL_TRUE, "the program does not link");
  glUseProgram(program);
}

void OpenGlTiles::make_target() {
  const int width = tiles_a_side_ * scene_->window.width, height = tiles_a_side_ * scene_->window.height;
  GLuint frame = 0, target = 0, uniforms = 0;
  glGenFramebuffers(1, &frame);
  glBindFramebuffer(GL_FRAMEBUFFER, frame);
  glGenRenderbuffers(1, &target);
  glBindRenderbuffer(GL_RENDERBUFFER, target);
  glRenderbufferStorage(GL_RENDERBUFFER, GL_R8, width, height);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, target);
  expect(glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE, "no target of one byte per pixel");
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  pixels_.resize(static_cast<size_t>(width) * static_cast<size_t>(height));

  GLint alignment = 1;
  glGetIntegerv(GL_UNIFORM_BUFFER_OFFSET_ALIGNMENT, &alignment);
  const auto align = static_cast<size_t>(alignment);
  palette_stride_ = (num_joints_ * sizeof(ClipFromRest) + align - 1) / align * align;
  palettes_.resize(palette_stride_ * static_cast<size_t>(tiles_a_side_ * tiles_a_side_));
  glGenBuffers(1, &uniforms);
  glBindBuffer(GL_UNIFORM_BUFFER, uniforms);
}

void OpenGlTiles::draw(size_t first, size_t count) {
  for (size_t n = 0; n < count; ++n) {
    clip_from_rest(*scene_, scene_->pose(first + n), palette_);
    std::memcpy(&palettes_[n * palette_stride_], palette_.data(), num_joints_ * sizeof(ClipFromRest));
  }
  GLint uniforms = 0;
  glGetIntegerv(GL_UNIFORM_BUFFER_BINDING, &uniforms);
  glBufferData(GL_UNIFORM_BUFFER, static_cast<GLsizeiptr>(palettes_.size()), palettes_.data(), GL_STREAM_DRAW);
  glDisable(GL_SCISSOR_TEST);
  glClear(GL_COLOR_BUFFER_BIT);
  glEnable(GL_SCISSOR_TEST);
  const int width = scene_->window.width, height = scene_->window.height;
  for (size_t n = 0; n < count; ++n) {
    const int x = static_cast<int>(n) % tiles_a_side_ * width, y = static_cast<int>(n) / tiles_a_side_ * height;
    glViewport(x, y, width, height);
    glScissor(x, y, width, height);
    glBindBufferRange(GL_UNIFORM_BUFFER, 0, static_cast<GLuint>(uniforms), static_cast<GLintptr>(n * palette_stride_),
                      static_cast<GLsizeiptr>(num_joints_ * sizeof(ClipFromRest)));
    glDrawElements(GL_TRIANGLES, num_indices_, GL_UNSIGNED_SHORT, nullptr);
  }
}

void OpenGlTiles::distances(size_t first, std::span<const uint8_t> observed, std::span<int64_t> out) {
  make_current(true);
  const auto width = static_cast<size_t>(scene_->window.width), height = static_cast<size_t>(scene_->window.height);
  const auto a_side = static_cast<size_t>(tiles_a_side_), stride = a_side * width;
  for (size_t begin = 0; begin < out.size(); begin += a_side * a_side) {
    const size_t count = std::min(a_side * a_side, out.size() - begin);
    draw(first + begin, count);
    glReadPixels(0, 0, static_cast<GLsizei>(stride), static_cast<GLsizei>((count + a_side - 1) / a_side * height),
                 GL_RED, GL_UNSIGNED_BYTE, pixels_.data());
    for (size_t n = 0; n < count; ++n) {
      const uint8_t* drawn = &pixels_[n / a_side * height * stride + n % a_side * width];
      const uint8_t* seen = observed.data();
      int64_t differing = 0;
      for (size_t y = 0; y < height; ++y, drawn += stride, seen += width) {
        int in_row = 0;
        for (size_t x = 0; x < width; ++x) in_row += (drawn[x] != 0) != (seen[x] != 0);
        differing += in_row;
      }
      out[begin + n] = differing;
    }
  }
  expect(glGetError() == GL_NO_ERROR, "drawing failed");
  make_current(false);
}

}  // namespace silpose::bench
