#include "silpose/segment/mask_mat.h"

namespace silpose {

cv::Mat mat_from_mask(const Mask& mask) {
  cv::Mat mat(mask.height(), mask.width(), CV_8U);
  for (int y = 0; y < mask.height(); ++y) {
    uint8_t* row = mat.ptr(y);
    const auto words = mask.row(y);
    for (int x = 0; x < mask.width(); ++x) row[x] = (words[static_cast<size_t>(x) >> 6] >> (x & 63)) & 1u ? 255 : 0;
  }
  return mat;
}

Mask mask_from_mat(const cv::Mat& mat) {
  Mask mask(mat.cols, mat.rows);
  for (int y = 0; y < mat.rows; ++y) {
    const uint8_t* row = mat.ptr(y);
    for (int x = 0; x < mat.cols; ++x) {
      if (row[x] != 0) mask.set(x, y);
    }
  }
  return mask;
}

}  // namespace silpose
