// Prints the size of a camera's images.
#include <silpose/geometry/camera.h>

#include <iostream>

int main() {
  const silpose::PinholeCamera camera = silpose::look_at_camera(320, 240, 300, {0, 1, 4}, {0, 1, 0});
  std::cout << camera.width << "x" << camera.height << "\n";
}
