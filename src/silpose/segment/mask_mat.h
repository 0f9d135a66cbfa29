// Masks as OpenCV's matrices, and back.
// Threads: functions without state.
#pragma once

#include <opencv2/core.hpp>

#include "silpose/image/mask.h"

namespace silpose {

// [H, W] of bytes: 255 where the mask is set.
cv::Mat mat_from_mask(const Mask& mask);

// Set where a byte is not 0. REQUIRES: one channel of bytes.
Mask mask_from_mat(const cv::Mat& mat);

}  // namespace silpose
