#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "silpose/video/ffmpeg.h"
#include "silpose/video/video.h"

extern "C" {
#include <libavutil/opt.h>
}

namespace silpose {
namespace {

struct OutputDelete {
  void operator()(AVFormatContext* output) const {
    avio_closep(&output->pb);
    avformat_free_context(output);
  }
};

// Ticks fine enough for any image's time, of which a frame's time at `fps` is a whole number.
struct Ticks {
  AVRational base;
  int64_t of_frame = 1;
};
Ticks ticks_of(double fps) {
  constexpr int kMostDenominator = 100'000, kAtLeast = 90'000;
  const AVRational rate = av_d2q(fps, kMostDenominator);
  const int finer = (kAtLeast + rate.num - 1) / rate.num;
  return {{1, rate.num * finer}, int64_t{rate.den} * finer};
}

}  // namespace

struct VideoWriter::Impl {
  std::string name;
  int width = 0, height = 0;
  Ticks ticks;
  int64_t next_tick = 0;
  std::optional<int64_t> first_ns;
  bool is_closed = false;
  std::unique_ptr<AVFormatContext, OutputDelete> output;
  AVStream* stream = nullptr;  // output's
  CodecHandle encoder;
  FrameHandle frame{av_frame_alloc()};
  PacketHandle packet{av_packet_alloc()};
  ScalerHandle scaler;
  cv::Mat padded;  // even sizes, as yuv420p wants

  [[nodiscard]] tl::unexpected<Error> not_writable(int code) const {
    return error("{}: not writable ({})", name, ffmpeg_text(code));
  }

  Result<void> open(int even_width, int even_height, double fps) {
    AVFormatContext* made = nullptr;
    if (const int code = avformat_alloc_output_context2(&made, nullptr, "mp4", nullptr); code < 0) {
      return not_writable(code);
    }
    output.reset(made);
    const AVCodec* const codec = avcodec_find_encoder(AV_CODEC_ID_H264);
    stream = codec == nullptr ? nullptr : avformat_new_stream(made, nullptr);
    if (stream == nullptr) return error("{}: cannot be written, there is no H.264 encoder", name);
    encoder.reset(avcodec_alloc_context3(codec));
    encoder->width = even_width;
    encoder->height = even_height;
    encoder->pix_fmt = AV_PIX_FMT_YUV420P;
    encoder->colorspace = AVCOL_SPC_SMPTE170M;
    encoder->color_range = AVCOL_RANGE_MPEG;
    ticks = ticks_of(fps);
    encoder->time_base = stream->time_base = ticks.base;
    encoder->framerate = stream->avg_frame_rate = av_d2q(fps, 100'000);
    encoder->gop_size = -1;     // the encoder's own
    encoder->thread_count = 1;  // the same bytes on any machine
    encoder->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
    av_opt_set(encoder->priv_data, "preset", "veryfast", 0);
    av_opt_set(encoder->priv_data, "crf", "23", 0);
    if (const int code = avcodec_open2(encoder.get(), codec, nullptr); code < 0) {
      return error("{}: {} by {} cannot be encoded ({})", name, even_width, even_height, ffmpeg_text(code));
    }
    avcodec_parameters_from_context(stream->codecpar, encoder.get());
    int code = avio_open(&made->pb, ffmpeg_path(name).c_str(), AVIO_FLAG_WRITE);
    if (code >= 0) code = avformat_write_header(made, nullptr);
    if (code < 0) return not_writable(code);
    frame->format = encoder->pix_fmt;
    frame->width = even_width;
    frame->height = even_height;
    scaler.reset(sws_getContext(even_width, even_height, AV_PIX_FMT_BGR24, even_width, even_height, encoder->pix_fmt,
                                SWS_BICUBIC, nullptr, nullptr, nullptr));
    if (!scaler || av_frame_get_buffer(frame.get(), 0) < 0) return error("{}: no memory", name);
    return {};
  }

  // Null: what the encoder still holds.
  Result<void> encode(const AVFrame* image) {
    if (const int code = avcodec_send_frame(encoder.get(), image); code < 0) {
      return error("{}: a frame cannot be encoded ({})", name, ffmpeg_text(code));
    }
    while (true) {
      const int code = avcodec_receive_packet(encoder.get(), packet.get());
      if (code == AVERROR(EAGAIN) || code == AVERROR_EOF) return {};
      if (code < 0) return error("{}: a frame cannot be encoded ({})", name, ffmpeg_text(code));
      av_packet_rescale_ts(packet.get(), encoder->time_base, stream->time_base);
      packet->stream_index = stream->index;
      packet->duration = av_rescale_q(ticks.of_frame, ticks.base, stream->time_base);
      if (const int failed = av_interleaved_write_frame(output.get(), packet.get()); failed < 0) {
        return not_writable(failed);
      }
    }
  }
};

VideoWriter::VideoWriter(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
VideoWriter::VideoWriter(VideoWriter&&) noexcept = default;
VideoWriter& VideoWriter::operator=(VideoWriter&&) noexcept = default;
VideoWriter::~VideoWriter() = default;

Result<void> VideoWriter::write(const ByteImage& image, std::optional<int64_t> time_ns) {
  Impl& impl = *impl_;
  check(image.channels() == 1 || image.channels() == 3, "VideoWriter: {} channels", image.channels());
  if (image.width() != impl.width || image.height() != impl.height) {
    return error("{}: an image of {}x{} for a video of {}x{}", impl.name, image.width(), image.height(), impl.width,
                 impl.height);
  }
  if (impl.is_closed) return error("{}: the video is closed", impl.name);
  cv::Mat colour(image.height(), image.width(), CV_8UC(image.channels()), const_cast<uint8_t*>(image.pixels().data()));
  if (image.channels() == 1) {
    const cv::Mat grey = colour;
    colour = cv::Mat();
    cv::cvtColor(grey, colour, cv::COLOR_GRAY2BGR);
  }
  cv::copyMakeBorder(colour, impl.padded, 0, image.height() % 2, 0, image.width() % 2, cv::BORDER_REPLICATE);
  if (av_frame_make_writable(impl.frame.get()) < 0) return error("{}: no memory", impl.name);
  const uint8_t* const rows[] = {impl.padded.data};
  const int stride[] = {static_cast<int>(impl.padded.step)};
  sws_scale(impl.scaler.get(), rows, stride, 0, impl.padded.rows, impl.frame->data, impl.frame->linesize);

  int64_t tick = impl.next_tick;
  if (time_ns) {
    if (!impl.first_ns) impl.first_ns = *time_ns;
    tick = av_rescale_q(*time_ns - *impl.first_ns, {1, 1'000'000'000}, impl.ticks.base);
    check(tick > impl.frame->pts || impl.next_tick == 0, "VideoWriter: an image at {} ns is not after the last",
          *time_ns);
  }
  impl.frame->pts = tick;
  impl.next_tick = tick + impl.ticks.of_frame;
  return impl.encode(impl.frame.get());
}

Result<void> VideoWriter::close() {
  Impl& impl = *impl_;
  if (std::exchange(impl.is_closed, true)) return {};
  if (Result<void> flushed = impl.encode(nullptr); !flushed) return flushed;
  const int ended = av_write_trailer(impl.output.get());
  const int closed = avio_closep(&impl.output->pb);
  if (ended < 0 || closed < 0) return impl.not_writable(std::min(ended, closed));
  return {};
}

Result<VideoWriter> create_video(const std::filesystem::path& path, int width, int height, double fps) {
  check(width > 0 && height > 0 && fps > 0, "create_video: {}x{} at {} frames per second", width, height, fps);
  const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
  std::error_code code;
  if (!std::filesystem::is_directory(folder, code)) return error("{}: no such directory", folder.string());
  silence_ffmpeg();
  auto impl = std::make_unique<VideoWriter::Impl>();
  impl->name = path.string();
  impl->width = width;
  impl->height = height;
  if (Result<void> opened = impl->open(width + width % 2, height + height % 2, fps); !opened) return opened.failure();
  return VideoWriter(std::move(impl));
}

}  // namespace silpose
