#include "silpose/segment/foreground.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "silpose/base/parallel.h"
#include "silpose/segment/cast_shadow.h"
#include "silpose/segment/foreground_evidence.h"

namespace silpose {
namespace {

constexpr int kBlock = 16;  // [guess] pixels

constexpr int kWindow = 3;  // pixels, of the means that are compared as well [tuned on rendered clips: 5 is no better]
// Weight of the eight neighbours together, and the step of colour (grey levels) across which they count half.
// [tuned on rendered clips: dance, jumping]
constexpr float kNeighbours = 4, kContrast = 12;
constexpr int kIterations = 4;
// A shadow lies next to the subject; "shadow" with more than this part of its outline against the subject is the
// subject. More is asked of what find_cast_shadow() marks, most of that on the floor: feet stand in their shadow.
// [tuned on rendered clips of recorded motions: dance, jumping, kick, punch]
constexpr double kEnclosed = 0.25, kEnclosedCast = 0.4, kEnclosedOnFloor = 0.8;
// [guess] Confidence: beliefs from this on are certain; what is shadow or subject is a guess.
constexpr float kSureBelief = 0.5f, kSureOfShadow = 0.4f;

float square(float x) { return x * x; }

ByteImage window_mean(const ByteImage& image) {
  ByteImage mean(image.width(), image.height(), 3);
  cv::blur(cv::Mat(image.height(), image.width(), CV_8UC3, const_cast<uint8_t*>(image.pixels().data())),
           cv::Mat(image.height(), image.width(), CV_8UC3, mean.pixels().data()), {kWindow, kWindow});
  return mean;
}

// tanh(x / 2), near enough.
float squash(float x) { return x / (1.5f + std::abs(x)); }

}  // namespace

float exposure_gain(const BackgroundModel& model, const ByteImage& luma_chroma) {
  std::vector<float> ratios;
  for (int y = 4; y < model.height(); y += 8) {
    for (int x = 4; x < model.width(); x += 8) {
      const uint8_t background = model.median.at(x, y), seen = luma_chroma.at(x, y);
      if (background >= 30 && background <= 235 && seen <= 250) {
        ratios.push_back(static_cast<float>(seen) / static_cast<float>(background));
      }
    }
  }
  if (ratios.size() < 32) return 1;
  const auto middle = ratios.begin() + static_cast<ptrdiff_t>(ratios.size() / 2);
  std::nth_element(ratios.begin(), middle, ratios.end());
  return std::clamp(*middle, 0.7f, 1.4f);
}

ForegroundFinder::ForegroundFinder(BackgroundModel model)
    : model_(std::move(model)),
      stride_(static_cast<size_t>(model_.width()) + 2),
      blocks_x_((model_.width() + kBlock - 1) / kBlock),
      blocks_y_((model_.height() + kBlock - 1) / kBlock) {
  const size_t pixels = static_cast<size_t>(model_.width()) * static_cast<size_t>(model_.height());
  inverse_noise_.resize(3 * pixels);
  for (size_t i = 0; i < pixels; ++i) {
    for (size_t c = 0; c < 3; ++c) inverse_noise_[c * pixels + i] = 1 / square(model_.noise.pixels()[3 * i + c]);
  }
  window_back_ = window_mean(model_.median);
  differs_ = ByteImage(model_.width(), model_.height());
  texture_.resize(pixels);
  const size_t size = stride_ * (static_cast<size_t>(model_.height()) + 2);
  for (auto* field : {&evidence_, &belief_, &next_, &right_, &down_, &down_right_, &down_left_}) field->assign(size, 0);
}

void ForegroundFinder::compare_texture(const ByteImage& luma_chroma) {
  const auto width = static_cast<size_t>(model_.width());
  parallel_for(static_cast<size_t>(model_.height()), kBlock, [&](size_t begin, size_t end) {
    std::vector<int32_t> sums(texture_sums_size(width));
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      TextureRows rows;
      for (int v = std::max(y - kTextureReach, 0); v <= std::min(y + kTextureReach, model_.height() - 1); ++v) {
        rows.seen[rows.count] = luma_chroma.row(v).data();
        rows.background[rows.count++] = model_.median.row(v).data();
      }
      compare_texture_row(rows, width, sums.data(), &texture_[static_cast<size_t>(y) * width]);
    }
  });
}

void ForegroundFinder::weigh_evidence(const ByteImage& luma_chroma, float gain) {
  const ByteImage around = window_mean(luma_chroma);
  const size_t width = static_cast<size_t>(model_.width()), pixels = texture_.size();
  parallel_for(static_cast<size_t>(model_.height()), kBlock, [&](size_t begin, size_t end) {
    std::vector<float> least(width + 2 * kTextureReach);
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      const float* noise = &inverse_noise_[static_cast<size_t>(y) * width];
      EvidenceRow row{.seen = luma_chroma.row(y).data(),
                      .background = model_.median.row(y).data(),
                      .seen_around = around.row(y).data(),
                      .background_around = window_back_.row(y).data(),
                      .inverse_noise = {noise, noise + pixels, noise + 2 * pixels},
                      .gain = gain,
                      .width = width};
      for (int v = -kTextureReach; v <= kTextureReach; ++v) {
        const int in_image = std::clamp(y + v, 0, model_.height() - 1);
        row.texture[static_cast<size_t>(v + kTextureReach)] = &texture_[static_cast<size_t>(in_image) * width];
      }
      float* evidence = &evidence_[(static_cast<size_t>(y) + 1) * stride_ + 1];
      weigh_evidence_row(row, least.data(), evidence, differs_.row(y).data());
      std::transform(evidence, evidence + width, &belief_[(static_cast<size_t>(y) + 1) * stride_ + 1], squash);
    }
  });
}

void ForegroundFinder::add_evidence(const Image<float>& others) {
  parallel_for(static_cast<size_t>(model_.height()), kBlock, [&](size_t begin, size_t end) {
    for (size_t y = begin; y < end; ++y) {
      const std::span<const float> from = others.row(static_cast<int>(y));
      float *evidence = &evidence_[(y + 1) * stride_ + 1], *belief = &belief_[(y + 1) * stride_ + 1];
      for (size_t x = 0; x < from.size(); ++x) {
        evidence[x] += from[x];
        belief[x] = squash(evidence[x]);
      }
    }
  });
}

void ForegroundFinder::take_out_shadow(const ByteImage& luma_chroma, float gain) {
  cast_ = find_cast_shadow(model_, luma_chroma, gain, differs_);
  for (int y = 0; y < model_.height(); ++y) {
    const std::span<const uint8_t> is_shadow = cast_.shadow.row(y);
    float *evidence = &evidence_[(static_cast<size_t>(y) + 1) * stride_ + 1],
          *belief = &belief_[(static_cast<size_t>(y) + 1) * stride_ + 1];
    for (size_t x = 0; x < is_shadow.size(); ++x) {
      if (is_shadow[x] == 0) continue;
      evidence[x] = -kMostAgainst;
      belief[x] = squash(-kMostAgainst);
    }
  }
}

// Blocks with a pixel that may be foreground, and those around them: elsewhere nothing can change.
void ForegroundFinder::choose_blocks() {
  const size_t count = static_cast<size_t>(blocks_x_) * static_cast<size_t>(blocks_y_);
  std::vector<uint8_t> active(count, 0);
  parallel_for(static_cast<size_t>(blocks_y_), 1, [&](size_t begin, size_t end) {
    for (size_t block_y = begin; block_y < end; ++block_y) {
      const int last = std::min((static_cast<int>(block_y) + 1) * kBlock, model_.height());
      for (int y = static_cast<int>(block_y) * kBlock; y < last; ++y) {
        const float* evidence = &evidence_[(static_cast<size_t>(y) + 1) * stride_ + 1];
        for (int x = 0; x < model_.width(); ++x) {
          if (evidence[x] > 0) active[block_y * static_cast<size_t>(blocks_x_) + static_cast<size_t>(x / kBlock)] = 1;
        }
      }
    }
  });
  chosen_.assign(count, 0);
  for (int y = 0; y < blocks_y_; ++y) {
    for (int x = 0; x < blocks_x_; ++x) {
      if (!active[static_cast<size_t>(y * blocks_x_ + x)]) continue;
      for (int v = std::max(y - 1, 0); v <= std::min(y + 1, blocks_y_ - 1); ++v) {
        for (int u = std::max(x - 1, 0); u <= std::min(x + 1, blocks_x_ - 1); ++u) {
          chosen_[static_cast<size_t>(v * blocks_x_ + u)] = 1;
        }
      }
    }
  }
}

template <class Body>
void ForegroundFinder::for_each_run(const Body& body) const {
  parallel_for(static_cast<size_t>(blocks_y_), 1, [&](size_t begin, size_t end) {
    for (int block_y = static_cast<int>(begin); block_y < static_cast<int>(end); ++block_y) {
      const uint8_t* chosen = &chosen_[static_cast<size_t>(block_y * blocks_x_)];
      for (int from = 0; from < blocks_x_;) {
        if (!chosen[from]) {
          ++from;
          continue;
        }
        int to = from;
        while (to < blocks_x_ && chosen[to]) ++to;
        const int x0 = from * kBlock, x1 = std::min(to * kBlock, model_.width());
        for (int y = block_y * kBlock; y < std::min((block_y + 1) * kBlock, model_.height()); ++y) body(x0, x1, y);
        from = to;
      }
    }
  });
}

// How strongly a pixel and its neighbour are tied.
void ForegroundFinder::tie_neighbours(const ByteImage& luma_chroma) {
  for_each_run([&](int x0, int x1, int y) {
    constexpr float kStraight = kNeighbours / 6.83f, kSlanted = 0.7071f * kStraight;  // 4 + 4 * 0.7071
    const bool is_last = y + 1 == model_.height();
    const uint8_t* here = luma_chroma.row(y).data();
    const uint8_t* below = luma_chroma.row(is_last ? y : y + 1).data();
    const auto tie = [](const uint8_t* a, const uint8_t* b, float weight) {
      const int s0 = a[0] - b[0], s1 = a[1] - b[1], s2 = a[2] - b[2];
      return weight / (1 + static_cast<float>(s0 * s0 + s1 * s1 + s2 * s2) * (1 / square(kContrast)));
    };
    for (int x = x0; x < x1; ++x) {
      const size_t i = (static_cast<size_t>(y) + 1) * stride_ + 1 + static_cast<size_t>(x);
      const ptrdiff_t p = ptrdiff_t{3} * x;
      if (x + 1 < model_.width()) right_[i] = tie(here + p, here + p + 3, kStraight);
      if (is_last) continue;
      down_[i] = tie(here + p, below + p, kStraight);
      if (x + 1 < model_.width()) down_right_[i] = tie(here + p, below + p + 3, kSlanted);
      if (x > 0) down_left_[i] = tie(here + p, below + p - 3, kSlanted);
    }
  });
}

void ForegroundFinder::smooth_beliefs() {
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    for_each_run([&](int x0, int x1, int y) {
      const size_t row = (static_cast<size_t>(y) + 1) * stride_ + 1;
      const float *b = belief_.data(), *r = right_.data(), *d = down_.data(), *dr = down_right_.data(),
                  *dl = down_left_.data(), *e = evidence_.data();
      float* to = next_.data();
      for (size_t i = row + static_cast<size_t>(x0); i < row + static_cast<size_t>(x1); ++i) {
        const size_t up = i - stride_, low = i + stride_;
        to[i] = squash(e[i] + r[i] * b[i + 1] + r[i - 1] * b[i - 1] + d[i] * b[low] + d[up] * b[up] +
                       dr[i] * b[low + 1] + dr[up - 1] * b[up - 1] + dl[i] * b[low - 1] + dl[up + 1] * b[up + 1]);
      }
    });
    for_each_run([&](int x0, int x1, int y) {
      const auto at = static_cast<ptrdiff_t>((static_cast<size_t>(y) + 1) * stride_ + 1);
      std::copy(next_.begin() + at + x0, next_.begin() + at + x1, belief_.begin() + at + x0);
    });
  }
  // What is chosen in the next image is not tied to what was left of this one.
  for_each_run([&](int x0, int x1, int y) {
    const auto at = static_cast<ptrdiff_t>((static_cast<size_t>(y) + 1) * stride_ + 1);
    for (auto* ties : {&right_, &down_, &down_right_, &down_left_}) {
      std::fill(ties->begin() + at + x0, ties->begin() + at + x1, 0.0f);
    }
  });
}

void ForegroundFinder::keep_enclosed_shadows(Mask& mask) const {
  const int width = model_.width(), height = model_.height();
  cv::Mat shadow(height, width, CV_8U, cv::Scalar(0));
  for_each_run([&](int x0, int x1, int y) {
    const uint8_t* differs = differs_.row(y).data();
    for (int x = x0; x < x1; ++x) shadow.at<uint8_t>(y, x) = differs[x] && !mask.get(x, y) ? 1 : 0;
  });
  cv::Mat labels;
  const int count = cv::connectedComponents(shadow, labels, 4, CV_32S);
  if (count == 1) return;
  const std::vector<int64_t> none(static_cast<size_t>(count), 0);
  std::vector<int64_t> against_subject = none, outline = none, area = none, cast = none, on_floor = none;
  for (int y = 0; y < height; ++y) {
    const int* row = labels.ptr<int>(y);
    for (int x = 0; x < width; ++x) {
      if (row[x] == 0) continue;
      const auto label = static_cast<size_t>(row[x]);
      ++area[label];
      if (cast_.shadow.at(x, y) != 0) ++(y >= cast_.floor_row ? on_floor : cast)[label];
      constexpr int kSteps[4][2] = {{-1, 0}, {1, 0}, {0, -1}, {0, 1}};
      for (const auto& step : kSteps) {
        const int u = x + step[0], v = y + step[1];
        const bool inside = u >= 0 && u < width && v >= 0 && v < height;
        if (inside && labels.at<int>(v, u) == row[x]) continue;
        ++outline[label];
        if (inside && mask.get(u, v)) ++against_subject[label];
      }
    }
  }
  for (int y = 0; y < height; ++y) {
    const int* row = labels.ptr<int>(y);
    for (int x = 0; x < width; ++x) {
      const auto label = static_cast<size_t>(row[x]);
      if (label == 0) continue;
      const double enclosed = 2 * on_floor[label] > area[label] ? kEnclosedOnFloor
                              : 2 * cast[label] > area[label]   ? kEnclosedCast
                                                                : kEnclosed;
      if (static_cast<double>(against_subject[label]) > enclosed * static_cast<double>(outline[label])) {
        mask.set(x, y);
      }
    }
  }
}

ByteImage ForegroundFinder::confidence(const Mask& found) const {
  ByteImage confidence(model_.width(), model_.height(), 1, 255);
  for_each_run([&](int x0, int x1, int y) {
    const float* belief = &belief_[(static_cast<size_t>(y) + 1) * stride_ + 1];
    const uint8_t* differs = differs_.row(y).data();
    for (int x = x0; x < x1; ++x) {
      float sure = std::min(std::abs(belief[x]) / kSureBelief, 1.0f);
      if (differs[x] && !found.get(x, y)) sure = std::min(sure, kSureOfShadow);
      if (belief[x] <= 0 && found.get(x, y)) sure = std::min(sure, kSureOfShadow);
      if (found.get(x, y) && cast_.looks_like.at(x, y) != 0) sure = std::min(sure, kSureOfShadow);
      confidence.at(x, y) = static_cast<uint8_t>(255 * sure);
    }
  });
  return confidence;
}

Mask ForegroundFinder::find(const ByteImage& luma_chroma, const Image<float>* others) {
  check(luma_chroma.width() == model_.width() && luma_chroma.height() == model_.height() && luma_chroma.channels() == 3,
        "ForegroundFinder: image {}x{}x{}, background {}x{}", luma_chroma.width(), luma_chroma.height(),
        luma_chroma.channels(), model_.width(), model_.height());
  const float gain = exposure_gain(model_, luma_chroma);
  compare_texture(luma_chroma);
  weigh_evidence(luma_chroma, gain);
  take_out_shadow(luma_chroma, gain);
  if (others != nullptr) {
    check(others->width() == model_.width() && others->height() == model_.height(),
          "ForegroundFinder: other evidence of {}x{}", others->width(), others->height());
    add_evidence(*others);
  }
  choose_blocks();
  tie_neighbours(luma_chroma);
  smooth_beliefs();
  Mask mask(model_.width(), model_.height());
  for_each_run([&](int x0, int x1, int y) {
    const float* belief = &belief_[(static_cast<size_t>(y) + 1) * stride_ + 1];
    const auto words = mask.row(y);
    for (int x = x0; x < x1; ++x) {
      words[static_cast<size_t>(x) >> 6] |= static_cast<uint64_t>(belief[x] > 0) << (x & 63);
    }
  });
  keep_enclosed_shadows(mask);
  return mask;
}

}  // namespace silpose
