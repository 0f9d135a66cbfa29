#include "silpose/image/pixel_converter.h"

#include "silpose/image/image_file.h"

namespace silpose {

Result<cv::Mat> PixelConverter::convert(const AVFrame& frame) {
  const Kind kind{frame.width, frame.height, frame.format, frame.colorspace, frame.color_range};
  if (!scaler_ || kind != kind_) {
    if (Result<void> ready = prepare(kind); !ready) return ready.failure();
  }
  if (sws_scale(scaler_.get(), frame.data, frame.linesize, 0, frame.height, converted_->data, converted_->linesize) <
      0) {
    return error("a picture cannot be converted");
  }
  return cv::Mat(kind.height, kind.width, CV_8UC3, converted_->data[0], static_cast<size_t>(converted_->linesize[0]));
}

Result<void> PixelConverter::prepare(const Kind& kind) {
  kind_ = kind;
  scaler_.reset();
  if (static_cast<uint64_t>(kind.width) * static_cast<uint64_t>(kind.height) > kMostPixels) {
    return error("{}x{} are more pixels than the {} that can be handled", kind.width, kind.height, kMostPixels);
  }
  converted_.reset(av_frame_alloc());
  converted_->format = AV_PIX_FMT_BGR24;
  converted_->width = kind.width;
  converted_->height = kind.height;
  // Not straight into an image: the scaler writes past a row's end unless rows are aligned.
  if (av_frame_get_buffer(converted_.get(), 0) < 0) {
    return error("no memory for a picture of {}x{}", kind.width, kind.height);
  }
  scaler_.reset(sws_getContext(kind.width, kind.height, static_cast<AVPixelFormat>(kind.format), kind.width,
                               kind.height, AV_PIX_FMT_BGR24, SWS_BICUBIC, nullptr, nullptr, nullptr));
  if (!scaler_) return error("pictures of an unknown kind");
  int *of_source = nullptr, *of_target = nullptr, source_range = 0, range = 0, brightness = 0, contrast = 0,
      saturation = 0;
  if (sws_getColorspaceDetails(scaler_.get(), &of_source, &source_range, &of_target, &range, &brightness, &contrast,
                               &saturation) >= 0) {
    const bool is_full = source_range != 0 || kind.range == AVCOL_RANGE_JPEG;
    sws_setColorspaceDetails(scaler_.get(), sws_getCoefficients(kind.colour_space), is_full ? 1 : 0, of_target, range,
                             brightness, contrast, saturation);
  }
  return {};
}

}  // namespace silpose
