#include "silpose/video/pixel_converter.h"

#include <cstdint>
#include <span>

#include "silpose/base/parallel.h"
#include "silpose/image/image_file.h"

namespace silpose {
namespace {

// Made when first needed, for all videos.
const ToneMap& tone_map_of(HdrTransfer transfer) {
  if (transfer == HdrTransfer::kHlg) {
    static const ToneMap hlg(HdrTransfer::kHlg);
    return hlg;
  }
  static const ToneMap pq(HdrTransfer::kPq);
  return pq;
}

}  // namespace

std::optional<HdrTransfer> hdr_transfer_of(const AVFrame& frame) {
  if (frame.color_trc == AVCOL_TRC_ARIB_STD_B67) return HdrTransfer::kHlg;
  if (frame.color_trc == AVCOL_TRC_SMPTE2084) return HdrTransfer::kPq;
  return std::nullopt;
}

Result<cv::Mat> PixelConverter::convert(const AVFrame& frame) {
  const Kind kind{.width = frame.width,
                  .height = frame.height,
                  .format = frame.format,
                  .colour_space = frame.colorspace,
                  .range = frame.color_range,
                  .hdr = hdr_transfer_of(frame)};
  if (!scaler_ || kind != kind_) {
    if (Result<void> ready = prepare(kind); !ready) return ready.failure();
  }
  if (sws_scale(scaler_.get(), frame.data, frame.linesize, 0, frame.height, converted_->data, converted_->linesize) <
      0) {
    return error("an image cannot be converted");
  }
  if (kind.hdr) {
    toned_.create(kind.height, kind.width, CV_8UC3);
    const ToneMap& tone_map = tone_map_of(*kind.hdr);
    const auto width = static_cast<size_t>(kind.width);
    parallel_for(static_cast<size_t>(kind.height), 16, [&](size_t begin, size_t end) {
      for (auto y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
        const auto row = [&](int plane) {  // of green, blue, red
          const uint8_t* const start = converted_->data[plane] + ptrdiff_t{y} * converted_->linesize[plane];
          return std::span(reinterpret_cast<const uint16_t*>(start), width);
        };
        tone_map.apply(row(2), row(0), row(1), {toned_.ptr<uint8_t>(y), 3 * width});
      }
    });
    return toned_;
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
  const AVPixelFormat target = kind.hdr ? AV_PIX_FMT_GBRP10LE : AV_PIX_FMT_BGR24;
  converted_->format = target;
  converted_->width = kind.width;
  converted_->height = kind.height;
  // Not straight into an image: the scaler writes past a row's end unless rows are aligned.
  if (av_frame_get_buffer(converted_.get(), 0) < 0) {
    return error("no memory for an image of {}x{}", kind.width, kind.height);
  }
  scaler_.reset(sws_getContext(kind.width, kind.height, static_cast<AVPixelFormat>(kind.format), kind.width,
                               kind.height, target, SWS_BICUBIC, nullptr, nullptr, nullptr));
  if (!scaler_) return error("images of an unknown kind");
  int *of_source = nullptr, *of_target = nullptr, source_range = 0, range = 0, brightness = 0, contrast = 0,
      saturation = 0;
  if (sws_getColorspaceDetails(scaler_.get(), &of_source, &source_range, &of_target, &range, &brightness, &contrast,
                               &saturation) >= 0) {
    const bool is_full = source_range != 0 || kind.range == AVCOL_RANGE_JPEG;
    const bool is_assumed = kind.hdr && kind.colour_space == AVCOL_SPC_UNSPECIFIED;
    const AVColorSpace colour_space = is_assumed ? AVCOL_SPC_BT2020_NCL : kind.colour_space;
    sws_setColorspaceDetails(scaler_.get(), sws_getCoefficients(colour_space), is_full ? 1 : 0, of_target, range,
                             brightness, contrast, saturation);
  }
  return {};
}

}  // namespace silpose
