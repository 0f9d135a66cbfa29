#include "silpose/segment/mask_mat.h"

namespace silpose {

cv::Mat mat_from_mask(const Mask& mask) {
  cv::Mat mat(mask.height(), mask.width(), CV_8U);
  for (int y = 0; y < mask.height(); ++y) {
    bytes_from_bits(mask.row(y), {mat.ptr(y), static_cast<size_t>(mask.width())});
  }
  return mat;
}

Mask mask_from_mat(const cv::Mat& mat) {
  Mask mask(mat.cols, mat.rows);
  for (int y = 0; y < mat.rows; ++y) bits_from_bytes({mat.ptr(y), static_cast<size_t>(mat.cols)}, mask.row(y));
  return mask;
}

}  // namespace silpose
