#include "silpose/video/video_file.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <string_view>
#include <utility>

#include "silpose/video/ffmpeg.h"
#include "silpose/video/pixel_converter.h"
#include "silpose/video/shown_image.h"

extern "C" {
#include <libavutil/display.h>
}

namespace silpose {
namespace {

// Cut where its index should come: what ISO media (MP4, MOV) say of themselves at their beginning.
bool starts_as_iso_media(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  std::string start(8, '\0');
  stream.read(start.data(), static_cast<std::streamsize>(start.size()));
  return stream && start.substr(4) == "ftyp";
}

double ratio_of(AVRational ratio) { return ratio.num > 0 && ratio.den > 0 ? av_q2d(ratio) : 0; }

// The 35 mm equivalent among metadata: of QuickTime as iPhones write it, or of EXIF (0xA405) as FFmpeg names it.
std::optional<double> focal_mm35_of(const AVDictionary* metadata) {
  constexpr double kLeast_mm = 5, kMost_mm = 2000;  // 0 stands for unknown in EXIF; lenses lie far within
  const AVDictionaryEntry* entry = nullptr;
  while ((entry = av_dict_get(metadata, "", entry, AV_DICT_IGNORE_SUFFIX)) != nullptr) {
    const std::string_view key(entry->key), text(entry->value);
    if (!key.starts_with("com.apple.quicktime.camera.focal_length.35mm_equivalent") && key != "FocalLengthIn35mmFilm") {
      continue;
    }
    const std::string_view number = text.substr(std::min(text.find_first_not_of(' '), text.size()));
    double mm = 0;
    const auto [end, failure] = std::from_chars(number.data(), number.data() + number.size(), mm);
    if (failure == std::errc() && mm >= kLeast_mm && mm <= kMost_mm) return mm;
  }
  return std::nullopt;
}

class VideoFile : public FrameSource {
 public:
  explicit VideoFile(std::string name)
      : name_(std::move(name)), packet_(av_packet_alloc()), decoded_(av_frame_alloc()) {}

  Result<void> rewind() override {
    if (Result<void> opened = open(); !opened) return opened;
    if (stream_->nb_frames > 0 || counted_) return {};
    count();
    return open();
  }

  [[nodiscard]] const std::string& name() const override { return name_; }
  [[nodiscard]] double fps() const override { return fps_; }
  [[nodiscard]] bool has_times() const override { return first_pts_.has_value(); }
  [[nodiscard]] int64_t num_frames_hint() const override {
    if (counted_) return *counted_;
    // What an edit list hides is counted, too, but not shown.
    const int64_t by_duration = std::llround(stream_duration_s() * fps_);
    return by_duration > 0 ? std::min(stream_->nb_frames, by_duration) : stream_->nb_frames;
  }
  [[nodiscard]] std::optional<double> focal_mm35() const override { return focal_mm35_; }
  [[nodiscard]] bool broke_off() const override { return broke_off_; }
  [[nodiscard]] std::vector<std::string> warnings() const override {
    std::vector<std::string> all = warnings_;
    if (num_undecoded_ > 0) all.push_back(fmt::format("{}: {} pieces cannot be decoded", name_, num_undecoded_));
    return all;
  }

  Result<std::optional<TimedImage>> next() override {
    constexpr int kMostFailures = 1000;  // of a decoder that keeps failing without consuming input
    for (int failures = 0; failures < kMostFailures;) {
      const int code = avcodec_receive_frame(decoder_.get(), decoded_.get());
      if (code == 0) return image();
      if (code == AVERROR_EOF) break;
      if (code != AVERROR(EAGAIN)) {
        ++num_undecoded_, ++failures;
      } else {
        failures = 0;
        feed();
      }
    }
    broke_off_ = broke_off_ || last_is_partial_ || ends_early();
    return std::optional<TimedImage>();
  }

 private:
  // Reopened for a rewind, too: seeking is not exact in every container.
  Result<void> open() {
    decoder_.reset();
    AVFormatContext* opened = nullptr;
    AVDictionary* options = nullptr;
    av_dict_set(&options, "protocol_whitelist", "file", 0);
    const int failed = avformat_open_input(&opened, ffmpeg_path(name_).c_str(), nullptr, &options);
    av_dict_free(&options);
    if (failed < 0) {
      if (failed == AVERROR_INVALIDDATA && starts_as_iso_media(name_)) {
        return error("{}: the file is cut off or damaged: its index cannot be read", name_);
      }
      return error("{}: not a video", name_);
    }
    input_.reset(opened);
    if (const int unknown = avformat_find_stream_info(opened, nullptr); unknown < 0) {
      return error("{}: not a video ({})", name_, ffmpeg_text(unknown));
    }
    const int best = av_find_best_stream(opened, AVMEDIA_TYPE_VIDEO, -1, -1, nullptr, 0);
    const AVStream* const stream = best < 0 ? nullptr : opened->streams[best];
    if (stream == nullptr || (stream->disposition & AV_DISPOSITION_ATTACHED_PIC) != 0) {  // the cover of a song
      const bool has_sound = av_find_best_stream(opened, AVMEDIA_TYPE_AUDIO, -1, -1, nullptr, 0) >= 0;
      return error("{}: {}", name_, has_sound ? "sound without a video" : "not a video");
    }
    stream_ = stream;
    fps_ = 0;  // until the decoder may have reported it
    num_given_ = num_undecoded_ = 0;
    end_s_ = 0;
    first_pts_.reset();
    all_sent_ = broke_off_ = last_is_partial_ = warned_interlaced_ = false;
    warnings_.clear();
    return open_decoder();
  }

  // Reads the file through without decoding it: what it does not say of itself. The stream ends with it.
  void count() {
    int64_t packets = 0, timed = 0, first = INT64_MAX, last = INT64_MIN;
    for (; av_read_frame(input_.get(), packet_.get()) >= 0; av_packet_unref(packet_.get())) {
      if (packet_->stream_index != stream_->index || (packet_->flags & AV_PKT_FLAG_DISCARD) != 0) continue;
      ++packets;
      if (packet_->pts == AV_NOPTS_VALUE) continue;
      ++timed;
      first = std::min(first, packet_->pts);
      last = std::max(last, packet_->pts);
    }
    counted_ = packets;
    if (timed == packets && last > first) {
      mean_fps_ = static_cast<double>(packets - 1) / (static_cast<double>(last - first) * av_q2d(stream_->time_base));
    }
  }

  Result<void> open_decoder() {
    const AVCodec* const codec = avcodec_find_decoder(stream_->codecpar->codec_id);
    if (codec == nullptr) return error("{}: no decoder for {}", name_, avcodec_get_name(stream_->codecpar->codec_id));
    decoder_.reset(avcodec_alloc_context3(codec));
    avcodec_parameters_to_context(decoder_.get(), stream_->codecpar);
    decoder_->pkt_timebase = stream_->time_base;
    decoder_->thread_count = 0;  // as many as there are cores
    if (const int failed = avcodec_open2(decoder_.get(), codec, nullptr); failed < 0) {
      return error("{}: {} cannot be decoded ({})", name_, codec->name, ffmpeg_text(failed));
    }
    return {};
  }

  // The next packet of the stream to the decoder.
  void feed() {
    if (all_sent_) return;
    while (true) {
      const int code = av_read_frame(input_.get(), packet_.get());
      if (code < 0) {
        broke_off_ = broke_off_ || (code != AVERROR_EOF && code != AVERROR(EAGAIN));
        all_sent_ = true;
        avcodec_send_packet(decoder_.get(), nullptr);
        return;
      }
      const AVRational ticks = input_->streams[packet_->stream_index]->time_base;
      if (packet_->pts != AV_NOPTS_VALUE) {
        end_s_ = std::max(end_s_, static_cast<double>(packet_->pts + packet_->duration) * av_q2d(ticks));
      }
      const bool is_ours = packet_->stream_index == stream_->index;
      if (is_ours) {
        last_is_partial_ = (packet_->flags & AV_PKT_FLAG_CORRUPT) != 0;
        if (avcodec_send_packet(decoder_.get(), packet_.get()) < 0) ++num_undecoded_;
      }
      av_packet_unref(packet_.get());
      if (is_ours) return;
    }
  }

  Result<std::optional<TimedImage>> image() {
    const AVFrame& frame = *decoded_;
    if (num_given_ == 0) look_at_first(frame);
    const bool has_fields = is_interlaced(frame);
    if (has_fields && !warned_interlaced_) {
      warnings_.push_back(fmt::format("{}: interlaced; one field of each image is used", name_));
    }
    warned_interlaced_ = warned_interlaced_ || has_fields;
    Result<cv::Mat> converted = converter_.convert(frame);
    if (!converted) return error("{}: {}", name_, converted.error().message);
    cv::Mat& stored = *converted;
    if (has_fields && stored.rows > 1) keep_one_field(stored, is_top_field_first(frame));
    TimedImage shown{.image = shown_image(stored, pixel_aspect_, turn_), .time_ns = time_of(frame)};
    ++num_given_;
    return std::optional<TimedImage>(std::move(shown));
  }

  void look_at_first(const AVFrame& frame) {
    // The base rate of the time stamps is exact where the rate is constant; where it is not, the mean counts.
    const double mean = mean_fps_ > 0 ? mean_fps_ : ratio_of(stream_->avg_frame_rate);
    fps_ = ratio_of(av_guess_frame_rate(input_.get(), const_cast<AVStream*>(stream_), nullptr));
    is_even_ = !(mean > 0 && std::abs(fps_ / mean - 1) > 0.01);
    if (!is_even_) fps_ = mean;
    if (frame.best_effort_timestamp != AV_NOPTS_VALUE) first_pts_ = frame.best_effort_timestamp;
    if (!first_pts_) fps_ = ratio_of(decoder_->framerate);  // the container's is made up then
    if (!(fps_ > 0 && fps_ <= 1000)) fps_ = 0;
    if (!first_pts_ && fps_ > 0) {
      warnings_.push_back(
          fmt::format("{}: carries no times; {:.3f} frames per second, according to its encoding", name_, fps_));
    }

    focal_mm35_.reset();
    for (const AVDictionary* metadata : {stream_->metadata, input_->metadata, frame.metadata}) {
      if (!focal_mm35_) focal_mm35_ = focal_mm35_of(metadata);
    }

    turn_ = {};
    if (const uint8_t* bytes = side_data_of(*stream_, AV_PKT_DATA_DISPLAYMATRIX)) {
      take_turn(bytes);
    } else if (const AVFrameSideData* data = av_frame_get_side_data(&frame, AV_FRAME_DATA_DISPLAYMATRIX)) {
      take_turn(data->data);
    }
    const double aspect = ratio_of(
        av_guess_sample_aspect_ratio(input_.get(), const_cast<AVStream*>(stream_), const_cast<AVFrame*>(&frame)));
    pixel_aspect_ = believed_pixel_aspect(aspect > 0 ? aspect : 1);
    if (pixel_aspect_ != 1) {
      warnings_.push_back(fmt::format("{}: pixels {:.3f} times as wide as high, made square", name_, pixel_aspect_));
    }
    if (const std::optional<HdrTransfer> hdr = hdr_transfer_of(frame)) {
      warnings_.push_back(
          fmt::format("{}: HDR ({}), converted to standard range", name_, *hdr == HdrTransfer::kHlg ? "HLG" : "PQ"));
    }
  }

  void take_turn(const uint8_t* bytes) {
    std::array<int32_t, 9> matrix{};
    std::copy_n(reinterpret_cast<const int32_t*>(bytes), matrix.size(), matrix.begin());
    if (const std::optional<Turn> turn = turn_of_matrix(matrix)) {
      turn_ = *turn;
    } else {
      warnings_.push_back(fmt::format("{}: turned by {:.0f} degrees, which is not a quarter turn; used as stored",
                                      name_, -av_display_rotation_get(matrix.data())));
    }
  }

  // Since the first image. Where a constant rate explains the stamp within the container's rounding, exactly that.
  [[nodiscard]] std::optional<int64_t> time_of(const AVFrame& frame) const {
    if (!first_pts_ || frame.best_effort_timestamp == AV_NOPTS_VALUE) return std::nullopt;
    constexpr int64_t kMostRounding_ns = 2'000'000;
    const AVRational nanoseconds{1, 1'000'000'000};
    const int64_t time = av_rescale_q(frame.best_effort_timestamp - *first_pts_, stream_->time_base, nanoseconds);
    if (fps_ == 0 || !is_even_) return time;
    const int64_t even = std::llround(static_cast<double>(num_given_) * 1e9 / fps_);
    const int64_t rounding = std::min(av_rescale_q(1, stream_->time_base, nanoseconds) + 1, kMostRounding_ns);
    return std::abs(time - even) <= rounding ? even : time;
  }

  [[nodiscard]] double stream_duration_s() const {
    return stream_->duration > 0 ? static_cast<double>(stream_->duration) * av_q2d(stream_->time_base) : 0;
  }
  // Images and sound end before the file says, by more than rounding may explain.
  [[nodiscard]] bool ends_early() const {
    if (input_->duration <= 0 || input_->duration_estimation_method == AVFMT_DURATION_FROM_BITRATE) return false;
    const double declared_s = static_cast<double>(input_->duration) / AV_TIME_BASE;
    const double start_s =
        input_->start_time == AV_NOPTS_VALUE ? 0 : static_cast<double>(input_->start_time) / AV_TIME_BASE;
    const double frame_s = fps_ > 0 ? 1 / fps_ : 0;
    return declared_s - (end_s_ - std::min(start_s, 0.0)) > std::max(3 * frame_s, 0.01 * declared_s);
  }

  std::string name_;
  InputHandle input_;
  CodecHandle decoder_;
  PacketHandle packet_;
  FrameHandle decoded_;
  PixelConverter converter_;
  const AVStream* stream_ = nullptr;  // input_'s
  std::optional<int64_t> counted_;    // images, where the container does not say
  double mean_fps_ = 0;               // of those counted
  double fps_ = 0, pixel_aspect_ = 1;
  double end_s_ = 0;      // of what was read, in the file's time
  bool is_even_ = false;  // at that rate
  Turn turn_;
  std::optional<double> focal_mm35_;
  std::optional<int64_t> first_pts_;
  int64_t num_given_ = 0, num_undecoded_ = 0;
  bool all_sent_ = false, broke_off_ = false, last_is_partial_ = false, warned_interlaced_ = false;
  std::vector<std::string> warnings_;
};

}  // namespace

Result<std::unique_ptr<FrameSource>> open_video_file(const std::string& path) {
  silence_ffmpeg();
  auto source = std::make_unique<VideoFile>(path);
  if (const Result<void> opened = source->rewind(); !opened) return opened.failure();
  return std::unique_ptr<FrameSource>(std::move(source));
}

}  // namespace silpose
