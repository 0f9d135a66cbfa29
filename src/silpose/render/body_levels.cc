#include "silpose/render/body_levels.h"

#include <algorithm>

#include "silpose/body/levels.h"
#include "silpose/render/level_accuracy.h"

namespace silpose {

void add_levels(BodyModel& body) {
  body.levels.clear();
  for (const int num_vertices : kKeptLevels) {
    BodyLevel level = simplify(body, num_vertices);
    if (level.vertices.size() >= body.rest.vertices.size()) break;  // no coarser than the body itself
    const LevelAccuracy accuracy = level_accuracy(body, level);
    level.mean_iou = accuracy.mean_iou;
    level.worst_iou = accuracy.worst_iou;
    body.levels.push_back(std::move(level));
  }
}

Result<const BodyLevel*> choose_level(const BodyModel& body, double mean_iou) {
  if (body.levels.empty()) return error("{}: has no levels of detail; 'silpose model lod' makes them", body.name);
  if (const BodyLevel* const level = coarsest_level(body, mean_iou)) return level;
  double best = 0;
  for (const BodyLevel& level : body.levels) best = std::max(best, level.mean_iou);
  return error("{}: no level of detail shares {} of its silhouettes with the whole body's, {:.4f} at most", body.name,
               mean_iou, best);
}

}  // namespace silpose
