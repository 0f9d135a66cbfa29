#include "silpose/segment/clean_up.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "silpose/segment/mask_mat.h"

namespace silpose {
namespace {

constexpr double kMinBlob = 0.0005;    // [guess] of the image
constexpr double kLeastCovered = 0.3;  // [guess] of an expected silhouette
// What belongs to a blob though it is apart from it: gap, of the blob's height; sizes, of its area.
// [tuned on rendered clips of recorded motions: dance, jumping, kick, punch]
constexpr double kPartGap = 0.04, kLeastPart = 0.005, kLargestPart = 0.3;

cv::Mat disc(int radius) {
  cv::Mat element(2 * radius + 1, 2 * radius + 1, CV_8U);
  for (int y = -radius; y <= radius; ++y) {
    for (int x = -radius; x <= radius; ++x) {
      element.at<uint8_t>(y + radius, x + radius) = x * x + y * y <= radius * radius ? 1 : 0;
    }
  }
  return element;
}

// Where a set pixel lies within `radius`.
cv::Mat within(const cv::Mat& mat, int radius) {
  constexpr int kSmall = 2;  // up to which a disc is quicker than distances
  cv::Mat result;
  if (radius <= kSmall) {
    cv::dilate(mat, result, disc(radius));
    return result != 0;
  }
  cv::distanceTransform(mat == 0, result, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  return result <= radius;
}

// Grown and shrunk again: gaps of up to twice the radius are closed. The image's border is no edge.
Mask close_gaps(const Mask& mask, int radius) {
  const Box box = mask.bounding_box();
  if (box.empty() || radius <= 0) return mask;
  const int x0 = std::max(box.x - radius - 1, 0), x1 = std::min(box.x + box.width + radius + 1, mask.width());
  const int y0 = std::max(box.y - radius - 1, 0), y1 = std::min(box.y + box.height + radius + 1, mask.height());
  cv::Mat mat = mat_from_mask(mask);
  cv::Mat around = mat(cv::Rect(x0, y0, x1 - x0, y1 - y0));
  const cv::Mat closed = within(within(around, radius) == 0, radius) == 0;
  closed.copyTo(around);
  return mask_from_mat(mat);
}

// Where the subject is expected, with a margin, as far as it lies in `part` of the image.
cv::Mat where_expected(const Mask& expected, const cv::Rect& part) {
  cv::Mat near = cv::Mat::zeros(part.size(), CV_8U);
  const Box box = expected.bounding_box();
  if (box.empty()) return near;
  const int margin = static_cast<int>(kExpectedMargin * box.height);
  const cv::Rect around = cv::Rect(box.x - margin, box.y - margin, box.width + 2 * margin, box.height + 2 * margin) &
                          cv::Rect(0, 0, expected.width(), expected.height());
  const cv::Rect common = around & part;
  if (common.empty()) return near;
  const cv::Mat grown = within(mat_from_mask(expected)(around), margin);
  grown(common - around.tl()).copyTo(near(common - part.tl()));
  return near;
}

// The blob `best`, and what is too large for noise, too small for another person, and close to it: a head, a hand, that
// a sleeve or a neck of the background's colour cuts off. `labels` [h, w] of the pixels set in `mat`.
std::vector<bool> parts_near(const cv::Mat& mat, const cv::Mat& labels, const std::vector<int64_t>& area, size_t best) {
  std::vector<bool> is_kept(area.size(), false);
  is_kept[best] = true;
  const auto is_part = [&](size_t label) {
    const auto size = static_cast<double>(area[label]), whole = static_cast<double>(area[best]);
    return label != best && size >= kLeastPart * whole && size <= kLargestPart * whole;
  };
  bool has_parts = false;
  for (size_t label = 1; label < area.size(); ++label) has_parts = has_parts || is_part(label);
  if (!has_parts) return is_kept;
  const cv::Mat blob = (labels == static_cast<int>(best)) & mat;
  const cv::Rect box = cv::boundingRect(blob);
  const int gap = static_cast<int>(std::lround(kPartGap * box.height));
  const cv::Rect around = cv::Rect(box.x - gap, box.y - gap, box.width + 2 * gap, box.height + 2 * gap) &
                          cv::Rect(0, 0, mat.cols, mat.rows);
  const cv::Mat near = within(blob(around), gap) & mat(around), near_labels = labels(around);
  for (int y = 0; y < near.rows; ++y) {
    for (int x = 0; x < near.cols; ++x) {
      const auto label = static_cast<size_t>(near_labels.at<int>(y, x));
      if (near.at<uint8_t>(y, x) && !is_kept[label]) is_kept[label] = is_part(label);
    }
  }
  return is_kept;
}

// The foreground, less what the garbage mask removes.
Mask without_garbage(const Mask& foreground, const std::optional<Mask>& garbage_mask) {
  Mask cut = foreground;
  if (!garbage_mask) return cut;
  check(garbage_mask->width() == cut.width() && garbage_mask->height() == cut.height(),
        "choose_blob: garbage mask {}x{}, image {}x{}", garbage_mask->width(), garbage_mask->height(), cut.width(),
        cut.height());
  for (int y = 0; y < cut.height(); ++y) {
    const auto to = cut.row(y);
    const auto keep = garbage_mask->row(y);
    for (size_t i = 0; i < to.size(); ++i) to[i] &= keep[i];
  }
  return cut;
}

// The blobs of a mask: label 0 is the background. Areas are in pixels of the mask itself.
struct Blobs {
  cv::Rect part;                                     // of the image: all that is worked on
  cv::Mat mat, labels;                               // of that part: the mask, and a label per pixel
  std::vector<int64_t> area, inside, expected_area;  // by label: whole, in the region, where the subject is expected
};

// Pixels of a gap of up to twice `reach` belong to one blob.
Blobs label_blobs(const Mask& mask, const cv::Rect& part, int reach, const std::optional<Box>& region,
                  const Mask& expected) {
  Blobs blobs{
      .part = part, .mat = mat_from_mask(mask)(part), .labels = {}, .area = {}, .inside = {}, .expected_area = {}};
  // Labelled on a copy that is grown by half of the gap.
  const cv::Mat joined = reach > 0 ? within(blobs.mat, reach) : blobs.mat;
  const auto count = static_cast<size_t>(cv::connectedComponents(joined, blobs.labels, 8, CV_32S));
  const cv::Mat near = where_expected(expected, part);
  blobs.area.assign(count, 0), blobs.inside.assign(count, 0), blobs.expected_area.assign(count, 0);
  for (int y = 0; y < part.height; ++y) {
    const int* row = blobs.labels.ptr<int>(y);
    const uint8_t* is_set = blobs.mat.ptr(y);
    for (int x = 0; x < part.width; ++x) {
      if (!is_set[x]) continue;
      const auto label = static_cast<size_t>(row[x]);
      ++blobs.area[label];
      const bool in_region = !region || (part.x + x >= region->x && part.x + x < region->x + region->width &&
                                         part.y + y >= region->y && part.y + y < region->y + region->height);
      if (in_region) ++blobs.inside[label];
      if (near.at<uint8_t>(y, x) != 0) ++blobs.expected_area[label];
    }
  }
  return blobs;
}

struct ChosenBlobs {
  std::vector<bool> is_kept;  // by label; empty: no blob counts
  int64_t area = 0;           // of all that are kept
};

// The blobs for the most part where the subject is expected; the largest one and its parts where these cover too little
// of `expected_area`, the area that is expected to be seen.
ChosenBlobs choose_among(const Blobs& blobs, double min_area, int64_t expected_area) {
  const size_t count = blobs.area.size();
  size_t best = 0;
  ChosenBlobs chosen{std::vector<bool>(count, false), 0};
  for (size_t label = 1; label < count; ++label) {
    const int64_t area = blobs.area[label];
    if (static_cast<double>(area) < min_area || 2 * blobs.inside[label] < area) continue;
    if (best == 0 || area > blobs.area[best]) best = label;
    if (2 * blobs.expected_area[label] < area || blobs.expected_area[label] == 0) continue;
    chosen.is_kept[label] = true;
    chosen.area += area;
  }
  if (best == 0) return {};
  const bool is_enough = static_cast<double>(chosen.area) >= kLeastCovered * static_cast<double>(expected_area);
  if (is_enough && chosen.area != 0) return chosen;
  chosen = {parts_near(blobs.mat, blobs.labels, blobs.area, best), 0};
  for (size_t label = 1; label < count; ++label) chosen.area += chosen.is_kept[label] ? blobs.area[label] : 0;
  return chosen;
}

// The pixels of the blobs that are kept, as a mask of their part of the image.
Mask mask_of(const Blobs& blobs, const std::vector<bool>& is_kept) {
  Mask mask(blobs.part.width, blobs.part.height);
  for (int y = 0; y < mask.height(); ++y) {
    const int* row = blobs.labels.ptr<int>(y);
    const uint8_t* is_set = blobs.mat.ptr(y);
    for (int x = 0; x < mask.width(); ++x) {
      if (is_set[x] && is_kept[static_cast<size_t>(row[x])]) mask.set(x, y);
    }
  }
  return mask;
}

}  // namespace

void CleanUpOptions::check() const {
  silpose::check(!region || !region->empty(), "region: width and height must be positive");
  silpose::check(min_blob_px >= -1, "min_blob_px is {}", min_blob_px);
  silpose::check(join_gap >= 0 && join_gap <= 0.1, "join_gap is {}", join_gap);
  silpose::check(max_hole >= 0 && max_hole <= 1, "max_hole is {}", max_hole);
  silpose::check(std::abs(grow_px) <= 200, "grow_px is {}", grow_px);
}

Mask fill_holes(const Mask& mask, int64_t max_area) {
  const Box box = mask.bounding_box();
  if (box.empty() || max_area <= 0) return mask;
  const cv::Mat mat = mat_from_mask(mask);
  // Within the bounding box every hole is enclosed; what touches the box's border is outside.
  const cv::Mat background = mat(cv::Rect(box.x, box.y, box.width, box.height)) == 0;
  cv::Mat labels, stats, centres;
  const int count = cv::connectedComponentsWithStats(background, labels, stats, centres, 4, CV_32S);
  std::vector<bool> is_hole(static_cast<size_t>(count), false);
  for (int label = 1; label < count; ++label) {
    const int* s = stats.ptr<int>(label);
    is_hole[static_cast<size_t>(label)] = s[cv::CC_STAT_AREA] <= max_area && s[cv::CC_STAT_LEFT] > 0 &&
                                          s[cv::CC_STAT_TOP] > 0 &&
                                          s[cv::CC_STAT_LEFT] + s[cv::CC_STAT_WIDTH] < box.width &&
                                          s[cv::CC_STAT_TOP] + s[cv::CC_STAT_HEIGHT] < box.height;
  }
  Mask filled = mask;
  for (int y = 0; y < box.height; ++y) {
    const int* row = labels.ptr<int>(y);
    for (int x = 0; x < box.width; ++x) {
      if (is_hole[static_cast<size_t>(row[x])]) filled.set(box.x + x, box.y + y);
    }
  }
  return filled;
}

Mask grow(const Mask& mask, int radius_px) {
  if (radius_px == 0 || mask.bounding_box().empty()) return mask;
  const cv::Mat element = disc(std::abs(radius_px));
  cv::Mat mat = mat_from_mask(mask), result;
  if (radius_px > 0) {
    cv::dilate(mat, result, element);
  } else {
    cv::erode(mat, result, element);  // OpenCV's default border does not erode
  }
  return mask_from_mat(result);
}

std::shared_ptr<const Mask> removed_by(const std::optional<Mask>& garbage_mask) {
  if (!garbage_mask) return {};
  auto removed = std::make_shared<Mask>(garbage_mask->width(), garbage_mask->height());
  for (int y = 0; y < removed->height(); ++y) {
    for (int x = 0; x < removed->width(); ++x) removed->set(x, y, !garbage_mask->get(x, y));
  }
  return removed->count() > 0 ? removed : nullptr;
}

Mask choose_blob(const Mask& foreground, const CleanUpOptions& options, const Mask& expected) {
  options.check();
  check(expected.width() == 0 || (expected.width() == foreground.width() && expected.height() == foreground.height()),
        "choose_blob: a silhouette of {}x{} is expected, image {}x{}", expected.width(), expected.height(),
        foreground.width(), foreground.height());
  const Mask cut = without_garbage(foreground, options.garbage_mask);
  Mask blob(cut.width(), cut.height());
  const Box all = cut.bounding_box();
  if (all.empty()) return blob;

  // Only what lies around the foreground is worked on, with room for what is grown.
  const int reach = static_cast<int>(std::lround(0.5 * options.join_gap * cut.height()));
  const int room = 2 * reach + std::max(options.grow_px, 0) + 2;
  const int x0 = std::max(all.x - room, 0), x1 = std::min(all.x + all.width + room, cut.width());
  const int y0 = std::max(all.y - room, 0), y1 = std::min(all.y + all.height + room, cut.height());
  const Blobs blobs = label_blobs(cut, {x0, y0, x1 - x0, y1 - y0}, reach, options.region, expected);

  const double min_area = options.min_blob_px >= 0 ? options.min_blob_px : kMinBlob * cut.width() * cut.height();
  const bool is_cut = options.garbage_mask && expected.width() > 0;
  const ChosenBlobs chosen =
      choose_among(blobs, min_area, is_cut ? and_count(expected, *options.garbage_mask) : expected.count());
  if (chosen.is_kept.empty()) return blob;

  const auto max_hole = static_cast<int64_t>(options.max_hole * static_cast<double>(chosen.area));
  const Mask closed = close_gaps(mask_of(blobs, chosen.is_kept), reach);
  const Mask part = grow(fill_holes(closed, max_hole), options.grow_px);
  for (int y = 0; y < part.height(); ++y) {
    for (int x = 0; x < part.width(); ++x) {
      if (part.get(x, y)) blob.set(x0 + x, y0 + y);
    }
  }
  return blob;
}

}  // namespace silpose
