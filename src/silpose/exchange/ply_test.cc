#include "silpose/exchange/ply.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <limits>

namespace silpose {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

const std::string kHeader =
    "ply\nformat binary_little_endian 1.0\ncomment metres\nelement vertex 2\nproperty uchar kind\nproperty float x\n"
    "property float y\nproperty float z\nproperty double s\nelement face 1\nproperty list uchar int vertex_indices\n"
    "end_header\n";

std::string row(float x, float y, float z) {
  std::string bytes(1, 'k');
  const double s = 0.5;
  for (const float value : {x, y, z}) bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  bytes.append(reinterpret_cast<const char*>(&s), sizeof s);
  return bytes;
}

Result<std::vector<Eigen::Vector3f>> read(const std::string& bytes) {
  const fs::path file = fs::path(testing::TempDir()) /
                        (std::string(testing::UnitTest::GetInstance()->current_test_info()->name()) + ".ply");
  std::ofstream(file, std::ios::binary) << bytes;
  auto vertices = read_ply_vertices(file);
  fs::remove(file);
  return vertices;
}

TEST(ReadPlyVertices, FindsTheCoordinatesAmongOtherProperties) {
  const std::string face = std::string("\3") + std::string(12, '\0');
  const auto vertices = read(kHeader + row(1, 2, 3) + row(-4.5F, 0, 1e-3F) + face).value();
  ASSERT_EQ(vertices.size(), 2U);
  EXPECT_EQ(vertices[0], Eigen::Vector3f(1, 2, 3));
  EXPECT_EQ(vertices[1], Eigen::Vector3f(-4.5F, 0, 1e-3F));
}

TEST(ReadPlyVertices, SaysWhatIsWrong) {
  const std::string rows = row(1, 2, 3) + row(4, 5, 6);
  const auto message = [&](const std::string& from, const std::string& to) {
    std::string header = kHeader;
    header.replace(header.find(from), from.size(), to);
    const auto vertices = read(header + rows);
    return vertices.error().message;
  };
  EXPECT_THAT(read("solid cube\n").error().message, HasSubstr("no PLY file"));
  EXPECT_THAT(read(kHeader + row(1, 2, 3)).error().message, HasSubstr("ends before its 2 vertices"));
  EXPECT_THAT(read(kHeader + row(1, 2, 3) + row(std::numeric_limits<float>::quiet_NaN(), 0, 0)).error().message,
              HasSubstr("vertex 1 is not finite"));
  EXPECT_THAT(message("binary_little_endian", "ascii"), HasSubstr("binary_little_endian"));
  EXPECT_THAT(message("float y", "float q"), HasSubstr("x, y and z"));
  EXPECT_THAT(message("float y", "double y"), HasSubstr("y is of type double"));
  EXPECT_THAT(message("uchar kind", "list uchar int kind"), HasSubstr("type 'list'"));
  EXPECT_THAT(message("element vertex 2", "element edge 2"), HasSubstr("first element is 'edge'"));
  EXPECT_THAT(read_ply_vertices("/nowhere/mesh.ply").error().message, HasSubstr("/nowhere/mesh.ply"));
}

}  // namespace
}  // namespace silpose
